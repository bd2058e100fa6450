#pragma once
// Model of a laboratory supervisor: a robot that has stopped in contact and waits for its bumper to be released is put
// back along its path and turned away from the contact.

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "base/tick_record.h"
#include "world/world.h"

namespace sf::scenarios {

struct SupervisorSettings {
  double patience = 0.0;     ///< [s] of standing in contact before the intervention; 0: no supervisor
  double back = 0.15;        ///< [m] back along its path
  double turn = M_PI / 4.0;  ///< [rad] away from the side in contact
};

class Supervisor {
 public:
  struct Intervention {
    std::uint32_t mover = 0;
    base::Pose X_WM;  ///< new pose
  };
  Supervisor(const world::World& world, const SupervisorSettings& settings);

  /// Called after every tick. @return interventions to apply before the next tick; lives until the next call
  std::span<const Intervention> update(const base::TickRecord& tick);

 private:
  struct Watched {
    std::vector<base::Pose> way;  ///< past poses at least 1 cm apart, the newest last
    double waited = 0.0;          ///< [s] standing in contact
  };
  base::Pose place_for(const base::Report& report, const Watched& watched) const;

  SupervisorSettings settings_;
  double interval_;  ///< [s]
  std::vector<Watched> watched_;
  std::vector<Intervention> interventions_;
};

}  // namespace sf::scenarios
