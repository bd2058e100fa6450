#pragma once
// Follows a line of magnets by an array of magnetometers across the robot (thesis, 4.3.3): e = z of the last element -
// z of the first, in Gauss, u = kp e + ki (integral of e), at constant speed. Element 0 is the rightmost, so a line to
// the left of the robot's middle makes e positive, and it turns left. An array that stops telling is held for `hold`
// seconds, then the robot stands.
//
// The thesis prints gains (0.01, 0.006) without a unit; here they are in rad/s per Gauss.

#include "control/path_task.h"
#include "control/pi_law.h"

namespace sf::control {

struct MagnetSettings {
  PiGains gains{.kp = 0.2};  ///< per Gauss
  double speed = 0.1;        ///< [m/s]
  double hold = 1.0;         ///< [s]
};

class MagnetKeeping final : public Controller {
 public:
  MagnetKeeping(const MagnetSettings& settings, const PathTask& task);

  base::Twist step(const Input& input) override;
  bool done() const override { return done_; }
  double error() const override { return error_; }  ///< [Gauss]

 private:
  MagnetSettings settings_;
  PathTask task_;
  PiLaw law_;
  Hold hold_;
  double error_;
  bool done_ = false;
};

extern const ControllerKind magnet_keeping_controller;

}  // namespace sf::control
