#pragma once
// Lane keeping by a camera's colours alone: no poses, lanes or paint of the world. Each image is rectified to the
// ground (vision/ground_raster.h), its paint found by OpenCV (PaintFinder, vision/opencv.h) and the lane tracked
// (vision/lane_tracker.h); between images the track moves with the robot's own commands. Steering is that of
// `lane-keeping`: kp times the lane's offset at a point ahead.

#include <memory>
#include <string>
#include <vector>

#include "control/controllers.h"
#include "control/lane_view.h"
#include "control/pi_controller.h"
#include "control/stop_reason.h"
#include "vision/lane_tracker.h"

namespace sf::control {

struct LaneCameraSettings {
  PiGains gains;
  double speed = 0.1;    ///< [m/s] while it sees its lane
  double hold = 1.0;     ///< [s] without a lane at this speed; then it slows down, and stops after twice this time
  double ahead = 0.225;  ///< [m] of the robot's origin: where the error is
};

/// Its error [m] is the robot's offset to the right of the lane's middle, `ahead` of it.
class LaneCamera final : public Controller, public StatesStopReason {
 public:
  LaneCamera(const LaneCameraSettings& settings, LaneView view, const vision::LaneLimits& limits);

  base::Twist step(const ControllerInput& input) override;
  double error() const override { return error_; }
  std::string stop_reason() const override;

 private:
  struct Command {
    std::int64_t from;  ///< [ns]
    base::Twist twist;
  };
  void look(const base::ReadingBlock& reading);
  void move(vision::LaneTracker& tracker, std::int64_t from, std::int64_t until) const;
  void advance(std::int64_t time);
  double speed_at(std::int64_t time) const;

  LaneCameraSettings settings_;
  LaneView view_;
  vision::LaneLimits limits_;
  PiController pi_;
  vision::LaneTracker tracker_;          ///< at `tracked_`
  std::int64_t tracked_ = 0;             ///< [ns]
  std::vector<Command> commands_;        ///< since `tracked_`, by time
  bool any_ = false, any_lane_ = false;  ///< whether there was an image, an image with a lane
  std::uint32_t sequence_ = 0;           ///< of the last image
  std::int64_t imaged_ = 0, seen_ = 0;   ///< [ns] of the last image, of the last image with the lane
  double error_ = Controller::error();
};

extern const ControllerType lane_camera_controller;

}  // namespace sf::control
