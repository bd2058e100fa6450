#pragma once
// Obstacle avoidance of the thesis (4.4.5, figure 46): drives forward at 0.1 m/s; at 0.05 m/s while an obstacle in
// front is nearer than 0.4 m. Below 0.2 m it turns to the side whose third of the field of view has the larger minimum,
// until the front third is clear.
//
// Distances are ranges, measured from the sensor. The thesis states no turning speed. "Until the front third is clear"
// is implemented as: no range in the front third is below `clear` (default: `turn`). With the default the robot may
// scrape an obstacle: a point 0.10 to 0.165 m off the axis leaves the front third before the disc of the Create has
// passed it.
//
// With `check_sweep` it executes only commands whose swept area is free (control/swept_area.h).

#include <span>

#include "control/controllers.h"
#include "control/swept_area.h"

namespace sf::control {

struct AvoidSettings {
  double speed = 0.1;        ///< [m/s]
  double slow_speed = 0.05;  ///< [m/s] while an obstacle in front is nearer than `slow`
  double slow = 0.4;         ///< [m]
  double turn = 0.2;         ///< [m] an obstacle in front nearer than this starts a turn
  double clear = 0.2;        ///< [m] a turn ends when the front third is free to this range; >= turn
  double turn_speed = 0.5;   ///< [rad/s]
};

class Avoid final : public Controller {
 public:
  explicit Avoid(const AvoidSettings& settings, std::optional<SweptArea> swept_area = {})
      : settings_(settings), swept_area_(std::move(swept_area)) {}

  /// Returns a zero twist until laser 0 has delivered a reading.
  base::Twist step(const ControllerInput& input) override;
  double v2v_range() const override { return swept_area_ ? swept_area_->v2v_range() : 0.0; }

  enum class State { drive, slow, turn_left, turn_right };
  State state() const { return state_; }

 private:
  base::Twist drive(const ControllerInput& input);

  AvoidSettings settings_;
  std::optional<SweptArea> swept_area_;
  State state_ = State::drive;
};

/// [m] Smallest range in each third of the field of view; infinity without ranges. Ignores NaN.
struct Thirds {
  double right, front, left;
};
Thirds thirds_of(std::span<const double> ranges);

extern const ControllerType avoid_controller;

}  // namespace sf::control
