#pragma once
// Checks the area that a robot's outline sweeps: while it executes a command and then brakes, no obstacle may come
// near the outline.
//
// Obstacles are echoes of the robot's lasers and sonars, kept for some seconds because a robot that turns or backs off
// moves over ground that its laser has left, and the states of other robots (V2V), as discs of its own size.
// Assumption: obstacles are slower than `kFastest`.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "control/controllers.h"
#include "control/settings.h"
#include "control/sonars.h"
#include "robots/footprint.h"

namespace sf::control {

class SweptArea {
 public:
  explicit SweptArea(const ControllerContext& context);

  /// Adds the echoes of this step and forgets old ones. Call it once per step.
  void update(const ControllerInput& input);
  /// Returns whether the robot may execute `command` until the next step and then brake: the outline keeps its margin
  /// to all obstacles or, where an obstacle is within the margin already, comes no nearer.
  bool free(const base::Report& state, const base::Twist& command) const;
  /// Returns the first command that is free: `wanted`, the same at half and a quarter of its speed, a turn at rate
  /// `turn` or the opposite one, backing off or driving ahead at `creep`. If none is free, it returns a stop.
  /// @param turn [rad/s] 0: the robot cannot turn in place  @param creep [m/s]
  base::Twist limit(const base::Report& state, const base::Twist& wanted, double turn, double creep) const;
  /// Returns the radius [m] within which states of other robots are needed.
  double v2v_range() const { return 2.0 * (outline_.radius + reach_); }

  static constexpr double kFastest = 0.25;  ///< [m/s] speed of moving obstacles

 private:
  struct Echo {
    glm::dvec2 p;           ///< [m] world frame
    std::int64_t time = 0;  ///< [ns] of the measurement
    std::int64_t kept = 0;  ///< [ns] it is forgotten after this time
  };
  void add_robots(const ControllerInput& input);
  void add_scan(const base::ReadingBlock& reading);
  void add_echoes(const Sonars::Source& source, const base::ReadingBlock& reading);
  void add(glm::dvec2 p, std::int64_t time, std::int64_t kept);
  double clearance(const base::Pose& X_WM, double most) const;

  world::Mover mover_;
  robots::Footprint outline_;
  std::vector<sensors::SensorSpec> lasers_;
  Sonars sonars_;
  double reach_;                    ///< [m] from the outline, of echoes that are kept
  base::Pose X_WM_;                 ///< at the last update
  std::vector<Echo> echoes_;        ///< within reach
  std::vector<glm::dvec2> robots_;  ///< [m] middles of discs that other robots may cover until they have stopped
};

/// Reads `check_sweep`. By default robots with sonars check, since these see behind the robot as well.
std::optional<SweptArea> read_swept_area(const ControllerContext& context, Settings& settings);

}  // namespace sf::control
