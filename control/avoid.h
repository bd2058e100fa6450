#pragma once
// The thesis' obstacle avoidance (4.4.5, figure 46), as described: straight on at 0.1 m/s; at 0.05 m/s while something
// in front is nearer than 0.4 m; when it is nearer than 0.2 m, a turn to the side whose third of the field of view has
// the larger minimum, until it is no longer in the front third.
//
// Distances are ranges, from the sensor. The thesis gives no turning speed; and "no longer in the front third" is read
// as: nothing nearer than `clear` there, unless given the distance at which it turned. As described it scrapes: a point
// 0.10 to 0.165 m off the axis leaves the front third before the disc of the Create has passed.

#include <span>

#include "control/controllers.h"

namespace sf::control {

struct AvoidSettings {
  double speed = 0.1;        ///< [m/s]
  double slow_speed = 0.05;  ///< [m/s] nearer than `slow`
  double slow = 0.4;         ///< [m]
  double turn = 0.2;         ///< [m] nearer than this it turns
  double clear = 0.2;        ///< [m] until nothing in front is nearer than this; >= turn
  double turn_speed = 0.5;   ///< [rad/s]
};

class Avoid final : public Controller {
 public:
  explicit Avoid(const AvoidSettings& settings) : settings_(settings) {}

  /// Stands until laser 0 has told something.
  base::Twist step(const ControllerInput& input) override;

  enum class State { drive, slow, turn_left, turn_right };
  State state() const { return state_; }

 private:
  AvoidSettings settings_;
  State state_ = State::drive;
};

/// [m] smallest range in each third of the field of view; infinity: none. What is not a number says nothing.
struct Thirds {
  double right, front, left;
};
Thirds thirds_of(std::span<const double> ranges);

extern const ControllerType avoid_controller;

}  // namespace sf::control
