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
// Without readings of the laser it drives by the sonar transducers that face forward: the front third has those whose
// axis is within 30 degrees of the robot's, the others those up to 90 degrees.
//
// With `check_sweep` it executes only commands whose swept area is free (control/swept_area.h).

#include <span>

#include "control/controllers.h"
#include "control/sonars.h"
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

/// [m] Smallest range in each third of the field of view; infinity without ranges. Ignores NaN.
struct Thirds {
  double right, front, left;
};
Thirds thirds_of(std::span<const double> ranges);

class Avoid final : public Controller {
 public:
  explicit Avoid(const AvoidSettings& settings, std::optional<SweptArea> swept_area = {}, Sonars sonars = {})
      : settings_(settings), swept_area_(std::move(swept_area)), sonars_(std::move(sonars)) {}

  /// Returns a zero twist until laser 0 or a sonar has delivered a reading.
  base::Twist step(const ControllerInput& input) override;
  std::uint64_t needs() const override;
  double v2v_range() const override { return swept_area_ ? swept_area_->v2v_range() : 0.0; }

  enum class State { drive, slow, turn_left, turn_right };
  State state() const { return state_; }

 private:
  std::optional<Thirds> nearest(const ControllerInput& input) const;
  base::Twist drive(const ControllerInput& input);

  AvoidSettings settings_;
  std::optional<SweptArea> swept_area_;
  Sonars sonars_;
  State state_ = State::drive;
};

extern const ControllerType avoid_controller;

}  // namespace sf::control
