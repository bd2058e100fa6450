#pragma once
// Follows a lane by its painted edge (thesis, 4.3.2): e = z - half the lane's width, u = kp e + ki (integral of e), at
// constant speed (control/path_task.h).

#include <optional>

#include "control/path_task.h"

namespace sf::control {

struct LaneSettings {
  PiGains gains{.kp = 0.5};          ///< per metre; of the controller by name: as its sensor's place asks for
  double speed = 0.1;                ///< [m/s]
  std::optional<double> half_width;  ///< [m] of the lane; none: of the path's piece under the sensor
  double side = 1.0;                 ///< +1: the sensor looks at the lane's left edge; -1: right
  double hold = 1.0;                 ///< [s]
  glm::dvec2 p_MS;                   ///< [m] the sensor's place in the robot's frame
};

/// Its error is [m] how far the robot is to the right of the lane's middle, by the edge.
class LaneKeeping final : public PathFollower {
 public:
  LaneKeeping(const LaneSettings& settings, const PathTask& task);

 private:
  double error_of(const base::ReadingBlock& reading, const base::Pose& X_WM) const override;

  LaneSettings settings_;
};

extern const ControllerType lane_keeping_controller;

}  // namespace sf::control
