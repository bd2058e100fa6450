#include "control/path_task.h"

#include <fmt/format.h>

#include <cmath>

namespace sf::control {

PathTask::PathTask(const ControllerContext& context, Settings& settings) {
  stop_before_ = settings.number("stop_before", stop_before_, 0.0, 1e6);
  const base::Pose& X_WM = context.world.movers[context.mover].X_WM;
  double least = HUGE_VAL;
  for (const world::Path& path : context.world.paths) {
    const double far = std::abs(world::project_onto(path, {X_WM.x, X_WM.y}).offset);
    if (!(far < least)) continue;
    least = far;
    path_ = &path;
  }
}

double PathTask::width_at(glm::dvec2 p) const { return path_->pieces[world::project_onto(*path_, p).piece].width; }

bool PathTask::ended(const base::Pose& X_WM) const {
  if (path_ == nullptr) return false;
  return world::project_onto(*path_, {X_WM.x, X_WM.y}).s >= world::length_of(*path_) - stop_before_;
}

bool SampleHold::is_fresh(const base::ReadingBlock* reading, std::int64_t time) {
  if (reading != nullptr && (!any_ || reading->sequence != sequence_)) {
    any_ = true;
    sequence_ = reading->sequence;
    last_reading_ = time;
  }
  return any_ && time - last_reading_ <= hold_;
}

double SampleHold::update(double now, std::int64_t time) {
  if (std::isfinite(now)) {
    last_ = now;
    last_value_time_ = time;
  } else if (time - last_value_time_ > hold_) {
    last_ = std::numeric_limits<double>::quiet_NaN();
  }
  return last_;
}

PathFollower::PathFollower(std::uint8_t type, std::string_view sensor, const PiGains& gains, double speed, double hold,
                           const PathTask& task)
    : type_(type), sensor_(sensor), speed_(speed), task_(task), pi_(gains), hold_(hold) {}

std::string PathFollower::stop_reason() const {
  if (done_ || std::isfinite(error_)) return {};
  return fresh_ ? fmt::format("its {} detects nothing to follow", sensor_)
                : fmt::format("no new readings arrive from its {}", sensor_);
}

base::Twist PathFollower::step(const ControllerInput& input) {
  error_ = Controller::error();
  if (done_ || (done_ = task_.ended(input.state.X_WM))) return {};
  const base::ReadingBlock* reading = newest(input, type_);
  fresh_ = hold_.is_fresh(reading, input.time);
  const double now = fresh_ && reading != nullptr ? error_of(*reading, input.state.X_WM) : Controller::error();
  error_ = hold_.update(now, input.time);
  if (!std::isfinite(error_)) return {};
  return {speed_, 0.0, std::isfinite(now) ? pi_.steer(now, input.time) : pi_.hold(error_)};
}

}  // namespace sf::control
