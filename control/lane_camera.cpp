#include "control/lane_camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "base/error.h"
#include "control/lane_keeping.h"
#include "sensors/camera.h"

namespace sf::control {

namespace {

constexpr std::int64_t kLongestTrail = 2'000'000'000;  // [ns] of commands that are kept for late images
constexpr double kMostCells = 1e6;                     // of the raster

/// Offset of the lane's middle to the left of a point [m] ahead of the robot, along its y axis.
double middle_at(const vision::Lane& lane, double ahead) {
  double y = 0.0;
  for (int k = 0; k < 4; ++k) {  // Newton's method; the slope is that of the lane's direction
    const double left = vision::left_of_middle(lane, {ahead, y});
    const double slope = (vision::left_of_middle(lane, {ahead, y + 1e-4}) - left) / 1e-4;
    y -= left / std::max(0.2, slope);
  }
  return y;
}

}  // namespace

LaneCamera::LaneCamera(const LaneCameraSettings& settings, LaneView view, const vision::LaneLimits& limits)
    : settings_(settings), view_(std::move(view)), limits_(limits), pi_(settings.gains), tracker_(limits) {}

void LaneCamera::look(const base::ReadingBlock& reading) {
  if (tracker_.update(view_.look(reading.values)))
    seen_ = reading.time, any_lane_ = true;
  else if (speed_at(reading.time) == 0.0)
    tracker_ = vision::LaneTracker(limits_);  // searches in the next image
}

/// Moves a track by the robot's commands, which the robot executes until the next one.
void LaneCamera::move(vision::LaneTracker& tracker, std::int64_t from, std::int64_t until) const {
  for (std::size_t i = 0; i < commands_.size(); ++i) {
    const std::int64_t begin = std::max(from, commands_[i].from),
                       end = i + 1 < commands_.size() ? std::min(until, commands_[i + 1].from) : until;
    if (end > begin) tracker.move(commands_[i].twist, 1e-9 * static_cast<double>(end - begin));
  }
}

/// Moves the track to a time, and drops the commands before it.
void LaneCamera::advance(std::int64_t time) {
  if (time <= tracked_) return;
  move(tracker_, tracked_, time);
  tracked_ = time;
  const auto later = std::ranges::find_if(commands_, [&](const Command& c) { return c.from > time; });
  if (later - commands_.begin() > 1) commands_.erase(commands_.begin(), later - 1);
}

double LaneCamera::speed_at(std::int64_t time) const {
  const double blind = 1e-9 * static_cast<double>(time - seen_);
  if (blind <= settings_.hold) return settings_.speed;
  return settings_.speed * std::max(0.0, 2.0 - blind / settings_.hold);
}

base::Twist LaneCamera::step(const ControllerInput& input) {
  const base::ReadingBlock* image = newest(input, sensors::kCamera);
  if (image != nullptr && (!any_ || image->sequence != sequence_)) {
    any_ = true, sequence_ = image->sequence, imaged_ = image->time;
    advance(image->time);
    look(*image);
  }
  advance(input.time - kLongestTrail);
  vision::LaneTracker now = tracker_;
  move(now, tracked_, input.time);
  base::Twist twist;
  error_ = Controller::error();
  if (const double speed = speed_at(input.time); any_lane_ && now.has_lane() && speed > 0.0) {
    error_ = middle_at(now.lane(), settings_.ahead);
    twist = {speed, 0.0, speed / settings_.speed * pi_.steer(error_, input.time)};
  }
  commands_.push_back({input.time, twist});
  return twist;
}

std::string LaneCamera::stop_reason() const {
  if (std::isfinite(error_)) return {};
  const double old =
      any_ && !commands_.empty() ? 1e-9 * static_cast<double>(commands_.back().from - imaged_) : HUGE_VAL;
  return old > settings_.hold ? "no new images arrive from its camera" : "its camera sees no lane";
}

namespace {

sensors::CameraSettings camera_of(const ControllerContext& context) {
  const world::Mover& mover = context.world.movers[context.mover];
  std::optional<sensors::SensorSet> made;
  const auto cameras = context.sensors_or(made).settings_of<sensors::CameraSettings>(sensors::kCamera, context.mover);
  if (cameras.empty() || !cameras[0].rgb)
    throw base::InputError(
        fmt::format("controller 'lane-camera': '{}' has no camera with colours; give it a camera( rgb 1 ... ) in the "
                    "world file",
                    mover.name));
  return cameras[0];
}

vision::GroundRaster read_raster(Settings& settings, double scale) {
  vision::GroundRaster raster;
  for (double* length : {&raster.near, &raster.far, &raster.side, &raster.cell}) *length *= scale;
  raster.near = settings.number("near", raster.near, -100.0, 100.0);
  raster.far = settings.number("far", raster.far, -100.0, 100.0);
  raster.side = settings.number("side", raster.side, 0.01, 100.0);
  raster.cell = settings.number("cell", raster.cell, 1e-4, 1.0);
  const double rows = std::round((raster.far - raster.near) / raster.cell),
               columns = 2.0 * std::round(raster.side / raster.cell);
  if (!(rows >= 10.0 && columns >= 20.0 && rows * columns <= kMostCells))
    settings.refuse(
        settings.has("cell")   ? "cell"
        : settings.has("far")  ? "far"
        : settings.has("near") ? "near"
                               : "side",
        fmt::format("the ground from {:g} to {:g} m ahead and {:g} m to each side has {:.0f} x {:.0f} cells "
                    "of {:g} m; expected at least 10 x 20, and at most {:g} in all",
                    raster.near, raster.far, raster.side, rows, columns, raster.cell, kMostCells));
  return raster;
}

std::unique_ptr<Controller> make_lane_camera(const ControllerContext& context, Settings& settings) {
  const world::Mover& mover = context.world.movers[context.mover];
  const sensors::CameraSettings camera = camera_of(context);
  const double scale = settings.number("scale", 1.0, 0.01, 100.0);
  const vision::GroundRaster raster = read_raster(settings, scale);
  vision::PaintLines lines;
  lines.gap *= scale, lines.widest *= scale;
  lines.contrast = settings.number("contrast", lines.contrast, 0.01, 10.0);
  const vision::LaneLimits limits{.scale = scale, .row = raster.cell};
  LaneCameraSettings lane;
  lane.ahead = settings.number("ahead", scale * lane.ahead, 0.0, raster.far);
  lane.speed = settings.number("speed", std::min(lane.speed, mover.max_forward), 0.0, mover.max_forward);
  lane.gains = read_gains(settings, {.kp = damped_gain(mover, lane.ahead, lane.speed)});
  lane.hold = settings.number("hold", lane.hold, 1e-3, 1e6);
  return std::make_unique<LaneCamera>(lane, LaneView(raster, lines, camera), limits);
}

}  // namespace

constinit const ControllerType lane_camera_controller{
    .name = "lane-camera",
    .summary = "follows a lane by a camera's images alone, with P or PI steering",
    .rate = 10.0,
    .stops_on_bumper = true,
    .make = make_lane_camera,
};

}  // namespace sf::control
