#pragma once
// Explores without a map: drives where it is free, slows down near things, turns to the freer side before it meets
// them, backs off and turns some random angle when it has met one all the same; what presses from behind it leaves
// there. Works with any laser, several, or none.

#include <cstdint>

#include "control/clearance_estimator.h"
#include "control/controllers.h"
#include "world/world.h"

namespace sf::control {

/// Distances are from the body's front, made from the mover's facts. [m]
struct WanderSettings {
  double speed = 0.4;   ///< [m/s] where it is free
  double turn = 1.0;    ///< [rad/s] where it is blocked
  double stop = 0.15;   ///< nearer than this it turns
  double resume = 0.3;  ///< farther than this it drives on; > stop
  double slow = 0.8;    ///< nearer than this it slows down; > resume
  bool turns_in_place = true;
};

WanderSettings wander_settings(const world::Mover& mover, double range);

class Wander final : public Controller {
 public:
  /// @param robot names the robot's own random numbers: the row of the mover
  Wander(const world::Mover& mover, std::uint32_t robot, std::uint64_t seed);

  /// A function of all inputs so far and of (seed, robot) alone.
  base::Twist step(const ControllerInput& input) override;

 private:
  enum class Mode { cruise, turn, back };
  double random();
  void choose(const ControllerInput& input, const Clearance& clearance);
  void drive_away(const Clearance& clearance);
  void start_turn(const Clearance& clearance, double least);
  void start_back(std::int64_t time);
  base::Twist cruise(const Clearance& clearance, std::int64_t time);
  base::Twist turn() const;

  ClearanceEstimator clearance_estimator_;
  WanderSettings settings_;
  std::uint32_t robot_;
  std::uint64_t seed_;
  std::uint64_t draws_ = 0;
  Mode mode_ = Mode::cruise;
  double side_ = 1.0;             ///< +1 turns left, -1 right
  double least_ = 0.0;            ///< [rad] still to turn before driving on
  double turned_ = 0.0;           ///< [rad] since this turn began
  double last_yaw_ = 0.0;         ///< [rad]
  std::int64_t until_ = 0;        ///< [ns] end of backing off
  std::int64_t drift_until_ = 0;  ///< [ns]
  double drift_ = 0.0;            ///< [rad/s] slow change of heading while it is free
};

extern const ControllerType wander_controller;

}  // namespace sf::control
