#pragma once
// Who stands by in the lab: a robot that is stopped and waits for its bumper to be released is taken by hand, put back
// along its own way and turned from what it touched.

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "base/sink.h"
#include "world/world.h"

namespace sf::scenarios {

struct SupervisorSettings {
  double patience = 0.0;     ///< [s] of standing in contact before the robot is taken; 0: nobody is there
  double back = 0.15;        ///< [m] along its own way
  double turn = M_PI / 4.0;  ///< [rad] from the side that is pressed
};

class Supervisor {
 public:
  struct Intervention {
    std::uint32_t mover = 0;
    base::Pose X_WM;  ///< where it is put
  };
  Supervisor(const world::World& world, const SupervisorSettings& plan);

  /// After every tick. @return who is to be put where before the next; lives until the next call
  std::span<const Intervention> update(const base::TickRecord& tick);

 private:
  struct Watched {
    std::vector<base::Pose> way;  ///< where it was, a centimetre apart, the newest last
    double waited = 0.0;          ///< [s]
  };
  base::Pose place_for(const base::Report& report, const Watched& watched) const;

  SupervisorSettings plan_;
  double interval_;  ///< [s]
  std::vector<Watched> watched_;
  std::vector<Intervention> interventions_;
};

}  // namespace sf::scenarios
