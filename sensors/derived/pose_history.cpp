#include "sensors/derived/pose_history.h"

#include <algorithm>
#include <cmath>

#include "base/time.h"

namespace sf::sensors {

namespace {

constexpr std::size_t kMostPoses = 256;
constexpr std::int64_t kLongestAhead = base::kSecond / 2;
constexpr std::int64_t kVelocityTime = base::kSecond / 2;
constexpr double kAcceleration = 0.5;   // [m/s^2], [rad/s^2] standard deviations beyond the newest pose
constexpr double kFarthestPlace = 1e7;  // [m]
constexpr std::size_t kPoseValidAt = 3, kPoseCovarianceAt = 4, kPoseNumbersStated = 10;

base::Pose between(const base::Pose& a, const base::Pose& b, double share) {
  return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), 0.0,
          base::wrap_angle(a.yaw + share * base::wrap_angle(b.yaw - a.yaw))};
}

double share_of(const StatedPose& a, const StatedPose& b, std::int64_t time) {
  return static_cast<double>(time - a.time) / static_cast<double>(b.time - a.time);
}

}  // namespace

void PoseHistory::take(const sensorfarm::Reading& reading, const std::vector<std::string>& columns) {
  const std::span<const double> v = reading.values;
  const bool stated = columns.size() >= kPoseNumbersStated && columns[kPoseValidAt] == "valid";
  if (stated && v[kPoseValidAt] == 0.0) return;
  if (!(std::abs(v[0]) <= kFarthestPlace && std::abs(v[1]) <= kFarthestPlace && std::isfinite(v[2]))) return;
  StatedPose pose{base::nanoseconds(reading.time), {v[0], v[1], 0.0, base::wrap_angle(v[2])}, {}};
  if (stated && std::isfinite(v[kPoseCovarianceAt]))
    std::copy_n(v.begin() + kPoseCovarianceAt, pose.covariance.size(), pose.covariance.begin());
  const auto place = std::ranges::lower_bound(poses_, pose.time, {}, &StatedPose::time);
  if (place != poses_.end() && place->time == pose.time)
    *place = pose;
  else
    poses_.insert(place, pose);
  if (poses_.size() > kMostPoses) poses_.pop_front();
}

std::optional<StatedPose> PoseHistory::at(std::int64_t time) const {
  if (poses_.empty() || time < poses_.front().time || time > poses_.back().time + kLongestAhead) return std::nullopt;
  const auto next = std::ranges::lower_bound(poses_, time, {}, &StatedPose::time);
  if (next != poses_.end() && next->time == time) return *next;
  if (next != poses_.end()) {
    const StatedPose &a = *std::prev(next), &b = *next;
    return StatedPose{time, between(a.X_WM, b.X_WM, share_of(a, b, time)), b.covariance};
  }
  StatedPose ahead = poses_.back();
  const double t = 1e-9 * static_cast<double>(time - ahead.time), error = 0.5 * kAcceleration * t * t;
  if (poses_.size() > 1) {
    const StatedPose& before = *std::prev(poses_.end(), 2);
    if (ahead.time - before.time <= kLongestAhead)
      ahead.X_WM = between(before.X_WM, ahead.X_WM, share_of(before, ahead, time));
  }
  ahead.time = time;
  for (const std::size_t k : {0, 3, 5}) ahead.covariance[k] += error * error;
  return ahead;
}

glm::dvec2 PoseHistory::velocity() const {
  if (poses_.size() < 2) return {};
  const StatedPose& last = poses_.back();
  auto first = std::ranges::lower_bound(poses_, last.time - kVelocityTime, {}, &StatedPose::time);
  if (first->time == last.time) return {};
  const double t = 1e-9 * static_cast<double>(last.time - first->time);
  return {(last.X_WM.x - first->X_WM.x) / t, (last.X_WM.y - first->X_WM.y) / t};
}

}  // namespace sf::sensors
