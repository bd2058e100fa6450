#pragma once
// Model of a laboratory supervisor. A robot that has stopped in contact and waits for its bumper to be released is
// moved back along its path and turned away from the contact.

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "base/tick_record.h"
#include "world/world.h"

namespace sf::scenarios {

struct SupervisorSettings {
  double patience = 0.0;     ///< [s] at rest in contact before the intervention; 0: no supervisor
  double back = 0.15;        ///< [m] distance back along its path
  double turn = M_PI / 4.0;  ///< [rad] away from the side in contact
};

class Supervisor {
 public:
  struct Intervention {
    std::uint32_t mover = 0;
    base::Pose X_WM;  ///< new pose
  };
  Supervisor(const world::World& world, const SupervisorSettings& settings);

  /// Call it after every tick.
  /// @return interventions to apply before the next tick; valid until the next call
  std::span<const Intervention> update(const base::TickRecord& tick);

 private:
  struct Watched {
    std::vector<base::Pose> way;  ///< past poses at least 1 cm apart, newest last
    double waited = 0.0;          ///< [s] at rest in contact
  };
  base::Pose place_for(const base::Report& report, const Watched& watched) const;

  SupervisorSettings settings_;
  double interval_;  ///< [s]
  std::vector<Watched> watched_;
  std::vector<Intervention> interventions_;
};

}  // namespace sf::scenarios
