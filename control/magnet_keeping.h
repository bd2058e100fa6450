#pragma once
// Follows a line of magnets with an array of magnetometers across the robot (thesis, 4.3.3): e = z of the last element
// - z of the first, in Gauss, u = kp e + ki (integral of e), at constant speed. Element 0 is the rightmost: a line to
// the left of the robot's centre makes e positive, and the robot turns left.
//
// The thesis prints the gains (0.01, 0.006) without a unit. Here gains are in rad/s per Gauss.

#include "control/path_task.h"

namespace sf::control {

struct MagnetSettings {
  PiGains gains{.kp = 0.2};  ///< per Gauss
  double speed = 0.1;        ///< [m/s]
  double hold = 1.0;         ///< [s]
};

/// Its error is in Gauss; NaN with fewer than two elements.
class MagnetKeeping final : public PathFollower {
 public:
  MagnetKeeping(const MagnetSettings& settings, const PathTask& task);

 private:
  double error_of(const base::ReadingBlock& reading, const base::Pose& X_WM) const override;
};

extern const ControllerType magnet_keeping_controller;

}  // namespace sf::control
