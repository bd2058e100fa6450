#pragma once
// Drives through given points to the last and back to the first, repeatedly; for pedestrians and Kheperas. Stops while
// another robot (V2V) is within its stopping distance ahead.

#include <vector>

#include "control/controllers.h"
#include "control/stop_reason.h"

namespace sf::control {

struct PatrolSettings {
  std::vector<glm::dvec2> points;  ///< [m] at least one
  double speed = 0.1;              ///< [m/s]
  double turn_speed = 1.0;         ///< [rad/s]
  double pause = 0.0;              ///< [s] pause at each end
  double reach = 0.03;             ///< [m] distance at which a point is reached
  double keep = 0.3;               ///< [m] between its own body and the origins of other robots
  double aside = 0.33;             ///< [m] half the width of the lane in which the origins of other robots stop it
  double radius = 0.165;           ///< [m] radius of its own body
  bool turns_in_place = true;      ///< false: a car, which drives while it turns
};

class Patrol final : public Controller, public StatesStopReason {
 public:
  explicit Patrol(PatrolSettings settings);

  base::Twist step(const ControllerInput& input) override;
  double v2v_range() const override;
  std::string stop_reason() const override { return stop_reason_; }
  std::uint64_t needs() const override { return 0; }

  std::size_t target() const { return target_; }  ///< index of the point to reach next

 private:
  bool obstructed(const ControllerInput& input) const;
  void next(std::int64_t time);

  PatrolSettings settings_;
  std::size_t target_ = 0;
  bool backwards_ = false;
  std::int64_t until_ = INT64_MIN;  ///< [ns] end of the pause
  const char* stop_reason_ = "";
};

extern const ControllerType patrol_controller;

}  // namespace sf::control
