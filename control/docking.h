#pragma once
// Drives an iRobot Create onto its dock with the infrared receiver: along the line between the beams of the red and the
// green buoy, slowly within the force field, until the bumper is pressed at the dock or the dock is reached. After
// contact with an obstacle it backs off and drives around the contacts so far, to where the dock's axis is free.
//
// The omnidirectional receiver measures no direction. Headings are therefore the robot's own, relative to the dock's
// pose in the world file. Before both buoys are received, and after contact with anything except the dock's face, the
// robot uses its own pose to drive to a staging point on the dock's axis.

#include <array>
#include <cstdint>
#include <optional>

#include "control/contact_map.h"
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
  double radius = 0.165;     ///< [m] of the robot
  double lean = 0.7;         ///< [rad] heading towards the axis while only one buoy is received
};

class Docking final : public Controller, public StatesStopReason {
 public:
  explicit Docking(const DockingSettings& settings) : settings_(settings) {}

  base::Twist step(const ControllerInput& input) override;
  base::Intent intent() const override { return {.docking = true}; }
  std::uint64_t needs() const override;
  bool done() const override { return done_; }
  std::string stop_reason() const override;

 private:
  glm::dvec2 from_dock(const base::Pose& X_WM) const;
  bool docked(const base::Pose& X_WM) const;
  base::Twist approach(const base::Pose& X_WM);
  base::Twist follow_beams(const base::Pose& X_WM);
  void take_contact(const base::Pose& X_WM, std::int64_t time);
  void plan(const glm::dvec2& p);
  base::Twist drive_around(const base::Pose& X_WM);

  DockingSettings settings_;
  bool follows_ = false;     ///< both buoys were received, and at least one of them ever since
  bool retreats_ = false;    ///< true after a contact, until both buoys are received from outside the force field
  bool contact_ = false;     ///< contact at the last step
  std::uint32_t light_ = 0;  ///< flags of the last reading with a buoy
  std::int64_t seen_ = 0;    ///< [ns] time of that reading
  double side_ = 0.0;        ///< direction of the current turn in place: +1 left, -1 right; 0: none
  bool done_ = false;
  bool onto_dock_ = false;               ///< drives along the axis to the dock, even without beams
  std::optional<ContactMap> obstacles_;  ///< in the dock's frame; nullopt: no contact yet, except at the dock
  std::array<double, 2> goals_{};        ///< [m] first and last x of the goals on the axis
  unsigned retries_ = 0;                 ///< contacts at the dock that did not dock
  std::int64_t back_until_ = 0;          ///< [ns] until which it backs off
  double back_ = 1.0;                    ///< direction of backing off: 1 backwards, -1 forwards
};

extern const ControllerType docking_controller;

}  // namespace sf::control
