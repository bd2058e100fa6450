#pragma once
// Drives an iRobot Create onto its dock with the infrared receiver: along the line between the beams of the red and the
// green buoy, slowly within the force field, until the bumper is pressed at the dock or the dock is reached.
//
// The omnidirectional receiver measures no direction. Headings are therefore the robot's own, relative to the dock's
// pose in the world file. Before both buoys are received, and after contact with anything except the dock's face, the
// robot uses its own pose to drive to a staging point on the dock's axis.

#include "control/controllers.h"
#include "control/stop_reason.h"

namespace sf::control {

struct DockingSettings {
  base::Pose X_WD;           ///< pose of the dock; its beams are along +x
  double stage = 1.0;        ///< [m] distance of the staging point before the dock
  double reach = 0.2;        ///< [m] distance between the robot's origin and the dock at which it is docked
  double speed = 0.1;        ///< [m/s]
  double slow_speed = 0.03;  ///< [m/s] within the force field
  double turn = 1.0;         ///< [rad/s] maximum
  double lean = 0.7;         ///< [rad] heading towards the axis while only one buoy is received
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
  bool follows_ = false;     ///< both buoys were received, and at least one of them ever since
  bool retreats_ = false;    ///< true after a contact, until both buoys are received from outside the force field
  bool contact_ = false;     ///< contact at the last step
  std::uint32_t light_ = 0;  ///< flags of the last reading with a buoy
  std::int64_t seen_ = 0;    ///< [ns] time of that reading
  double side_ = 0.0;        ///< direction of the current turn in place: +1 left, -1 right; 0: none
  bool done_ = false;
};

extern const ControllerType docking_controller;

}  // namespace sf::control
