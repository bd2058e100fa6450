#pragma once
// Follows a lane by its painted edge (thesis, 4.3.2): e = z - half the lane's width, u = kp e + ki (integral of e), at
// constant speed. It runs at its own rate and takes the newest reading each time, new or not, as the thesis' loop did.
//
// With no edge in sight it goes on with the last error for `hold` seconds and then stands until there is one again; the
// integral rests meanwhile. (The thesis says nothing of it.)

#include <optional>

#include "control/path_task.h"
#include "control/pi_law.h"

namespace sf::control {

struct LaneSettings {
  PiGains gains{.kp = 0.5};          ///< per metre
  double speed = 0.1;                ///< [m/s]
  std::optional<double> half_width;  ///< [m] of the lane; none: of the path's piece under the sensor
  double side = 1.0;                 ///< +1: the sensor looks at the lane's left edge; -1: right
  double hold = 1.0;                 ///< [s]
  base::Vec2 p_MS;                   ///< [m] the sensor's place in the robot's frame
};

class LaneKeeping final : public Controller {
 public:
  LaneKeeping(const LaneSettings& settings, const PathTask& task);

  base::Twist step(const Input& input) override;
  bool done() const override { return done_; }
  /// [m] how far the robot is to the right of the lane's middle, by the edge.
  double error() const override { return error_; }

 private:
  double error_of(const base::ReadingBlock& reading, const base::Pose& X_WM) const;

  LaneSettings settings_;
  PathTask task_;
  PiLaw law_;
  Hold hold_;
  double error_;
  bool done_ = false;
};

extern const ControllerKind lane_keeping_controller;

}  // namespace sf::control
