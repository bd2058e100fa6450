#pragma once
// Lane keeping by the painted edge (thesis, 4.3.2): e = z - half the lane's width, u = kp e + ki (integral of e), at
// constant speed (control/path_task.h).

#include <optional>

#include "control/path_task.h"

namespace sf::control {

struct LaneSettings {
  PiGains gains{.kp = 0.5};          ///< per metre; `lane-keeping` derives its default from the sensor's position
  double speed = 0.1;                ///< [m/s]
  std::optional<double> half_width;  ///< [m] half the lane's width; nullopt: the width of the path's piece under the
                                     ///< sensor
  double side = 1.0;                 ///< edge that the sensor measures: +1 left, -1 right
  double hold = 1.0;                 ///< [s]
  glm::dvec2 p_MS;                   ///< [m] position of the sensor in the robot's frame
};

/// Its error [m] is the robot's offset to the right of the lane's centre, measured from the edge.
class LaneKeeping final : public PathFollower {
 public:
  LaneKeeping(const LaneSettings& settings, const PathTask& task);

 private:
  double error_of(const base::ReadingBlock& reading, const base::Pose& X_WM) const override;

  LaneSettings settings_;
};

/// Returns the gain [rad/s per m] with which a robot returns to its lane without oscillation.
/// @param ahead [m] of the robot's origin: where the error is measured @param speed [m/s]
double damped_gain(const world::Mover& mover, double ahead, double speed);

extern const ControllerType lane_keeping_controller;

}  // namespace sf::control
