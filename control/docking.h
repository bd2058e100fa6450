#pragma once
// Takes an iRobot Create onto its dock by its infrared receiver: along the line between the red and the green buoy's
// beams, slowly within the force field, until the bumper touches or the dock is reached.
//
// The receiver sees all round and so tells no direction: headings are the robot's own, against the dock's as the world
// has it. Until it sees both buoys, and after it has touched anything but the dock's face, the robot drives to a place
// before the dock, on its axis, by its own pose.

#include "control/controllers.h"
#include "control/stop_reason.h"

namespace sf::control {

struct DockingSettings {
  base::Pose X_WD;           ///< the dock, its beams along x
  double stage = 1.0;        ///< [m] before the dock where its beams are looked for
  double reach = 0.2;        ///< [m] the robot's origin this near: docked
  double speed = 0.1;        ///< [m/s]
  double slow_speed = 0.03;  ///< [m/s] within the force field
  double turn = 1.0;         ///< [rad/s] at most
  double lean = 0.7;         ///< [rad] towards the axis with one buoy in sight
};

class Docking final : public Controller, public StatesStopReason {
 public:
  explicit Docking(const DockingSettings& settings) : settings_(settings) {}

  base::Twist step(const ControllerInput& input) override;
  base::Intent intent() const override { return {.docking = true}; }
  bool done() const override { return done_; }
  std::string stop_reason() const override;

 private:
  glm::dvec2 from_dock(const base::Pose& X_WM) const;
  bool docked(const base::Pose& X_WM) const;
  base::Twist approach(const base::Pose& X_WM);
  base::Twist follow_beams(const base::Pose& X_WM);

  DockingSettings settings_;
  bool follows_ = false;     ///< both buoys were in sight, and one has been since
  bool retreats_ = false;    ///< from a touch, until it sees both buoys from beyond the force field
  bool contact_ = false;     ///< at the last step
  std::uint32_t light_ = 0;  ///< the last with a buoy in it
  std::int64_t seen_ = 0;    ///< [ns] when that was
  double side_ = 0.0;        ///< of the turn in place that it is in: +1 left, -1 right; 0: it is in none
  bool done_ = false;
};

extern const ControllerType docking_controller;

}  // namespace sf::control
