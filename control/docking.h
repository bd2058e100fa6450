#pragma once
// Takes an iRobot Create onto its dock by its infrared receiver: along the line between the red and the green buoy's
// beams, slowly within the force field, until the bumper touches or the dock is reached.
//
// The receiver sees all round and so tells no direction: headings are the robot's own, against the dock's as the world
// has it. Out of the beams, or near the dock with one alone, the robot drives to a place before the dock, on its axis,
// by its own pose.

#include "control/controllers.h"

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

class Docking final : public Controller {
 public:
  explicit Docking(const DockingSettings& settings) : settings_(settings) {}

  base::Twist step(const Input& input) override;
  base::Intent intent() const override { return {.docking = true}; }
  bool done() const override { return done_; }

 private:
  base::Twist follow_beams(std::uint32_t light, const base::Pose& X_WM) const;

  DockingSettings settings_;
  bool lined_up_ = false;  ///< both buoys were in sight, and one has been since
  bool done_ = false;
};

extern const ControllerKind docking_controller;

}  // namespace sf::control
