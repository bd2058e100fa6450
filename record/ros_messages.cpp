#include "record/ros_messages.h"

#include <array>
#include <cmath>

#include "base/elementary.h"
#include "base/error.h"
#include "base/tilted_pose.h"
#include "base/time.h"
#include "record/cdr.h"

namespace sf::record {

using base::Bytes;
using base::Pose;
using base::Twist;

void put_time(CdrWriter& cdr, std::int64_t time) {
  SF_CHECK(time >= 0, "time " + std::to_string(time) + " ns");
  cdr.put(static_cast<std::int32_t>(time / base::kSecond));
  cdr.put(static_cast<std::uint32_t>(time % base::kSecond));
}

std::int64_t get_time(CdrReader& cdr) {
  const std::int64_t whole = cdr.get<std::int32_t>() * base::kSecond;
  return whole + cdr.get<std::uint32_t>();
}

void put_header(CdrWriter& cdr, std::int64_t time, std::string_view frame) {
  put_time(cdr, time);
  cdr.put(frame);
}

std::string get_header(CdrReader& cdr, std::int64_t& time) {
  time = get_time(cdr);
  return cdr.get_string();
}

void put_pose(CdrWriter& cdr, const Pose& pose, const base::Tilt& tilt) {
  const base::Quaternion q = base::quaternion_of(pose.yaw, tilt);
  for (const double value : {pose.x, pose.y, pose.z, q.x, q.y, q.z, q.w}) cdr.put(value);
}

void put_zeros(CdrWriter& cdr, int count) {
  for (int i = 0; i < count; ++i) cdr.put(0.0);
}

namespace {

void put_twist(CdrWriter& cdr, const Twist& twist) {
  for (const double value : {twist.forward, twist.left, 0.0, 0.0, 0.0, twist.turn}) cdr.put(value);
}

/// Writes the 6 x 6 covariance of x, y, z and rotations about them, given x, y and the rotation about z: xx, xy, x yaw,
/// yy, y yaw, yaw yaw.
void put_planar(CdrWriter& cdr, const std::array<double, 6>& P, double fixed) {
  std::array<double, 36> all{};
  constexpr std::size_t kAxes[3] = {0, 1, 5};
  for (std::size_t i = 0, k = 0; i < 3; ++i)
    for (std::size_t j = i; j < 3; ++j, ++k) all[6 * kAxes[i] + kAxes[j]] = all[6 * kAxes[j] + kAxes[i]] = P[k];
  for (const std::size_t axis : {2, 3, 4}) all[7 * axis] = fixed;
  for (const double value : all) cdr.put(value);
}

}  // namespace

void encode_odometry(const Transform& transform, const Twist& velocity, const OdometryCovariance& covariance,
                     Bytes& out) {
  const auto& [xx, xy, xa, yy, ya, aa] = covariance.pose;
  const auto& [ff, ft, tt] = covariance.twist;
  CdrWriter cdr(out);
  put_header(cdr, transform.time, transform.parent);
  cdr.put(transform.child);
  put_pose(cdr, transform.X_PC, transform.tilt);
  put_planar(cdr, {xx, xy, xa, yy, ya, aa}, covariance.fixed);
  put_twist(cdr, velocity);
  put_planar(cdr, {ff, 0.0, ft, covariance.fixed, 0.0, tt}, covariance.fixed);
}

void encode_twist(std::int64_t time, std::string_view frame, const Twist& twist, Bytes& out) {
  CdrWriter cdr(out);
  put_header(cdr, time, frame);
  put_twist(cdr, twist);
}

void encode_transforms(std::span<const Transform> transforms, Bytes& out) {
  CdrWriter cdr(out);
  cdr.put_count(transforms.size());
  for (const Transform& transform : transforms) {
    put_header(cdr, transform.time, transform.parent);
    cdr.put(transform.child);
    put_pose(cdr, transform.X_PC, transform.tilt);
  }
}

/// [ns] from the first beam, whose time is a message's stamp, to the last.
static std::int64_t duration_of(float time_increment, std::size_t samples) {
  const double seconds = static_cast<double>(time_increment) * static_cast<double>(samples > 0 ? samples - 1 : 0);
  return std::isfinite(seconds) && std::abs(seconds) < 1e6 ? base::nanoseconds(seconds) : 0;
}

void encode_scan(const Scan& scan, std::span<const double> ranges, Bytes& out) {
  CdrWriter cdr(out);
  // Before time 0 nothing moved: such a scan has one time.
  const std::int64_t duration = duration_of(scan.time_increment, ranges.size());
  const bool one_time = duration > scan.time;
  put_header(cdr, one_time ? scan.time : scan.time - duration, scan.frame);
  const bool one = ranges.size() < 2;
  const float fov = one ? 0.0F : scan.fov;
  cdr.put(-0.5F * fov);
  cdr.put(0.5F * fov);
  cdr.put(one ? 0.0F : fov / static_cast<float>(ranges.size() - 1));
  cdr.put(one_time ? 0.0F : scan.time_increment);
  cdr.put(scan.scan_time);
  cdr.put(base::float_below(scan.range_min));
  cdr.put(base::float_above(scan.range_max));
  cdr.put_count(ranges.size());
  for (const double range : ranges) cdr.put(base::rep117_range(range, {scan.range_min, scan.range_max}));
  cdr.put_count(0);
}

void encode_clock(std::int64_t time, Bytes& out) {
  CdrWriter cdr(out);
  cdr.put(static_cast<std::int32_t>(time / base::kSecond));
  cdr.put(static_cast<std::uint32_t>(time % base::kSecond));
}

void encode_state_quality(std::int64_t time, std::string_view frame, const base::StateQuality& quality, Bytes& out) {
  CdrWriter cdr(out);
  put_header(cdr, time, frame);
  cdr.put(quality.stale);
  cdr.put(1e-9 * static_cast<double>(quality.age));
  for (const float value : quality.covariance) cdr.put(value);
}

std::optional<Scan> decode_scan(std::span<const std::uint8_t> message) {
  CdrReader cdr(message);
  Scan scan;
  scan.frame = get_header(cdr, scan.time);
  const auto angle_min = cdr.get<float>();
  scan.fov = cdr.get<float>() - angle_min;
  cdr.get<float>();  // angle_increment
  scan.time_increment = cdr.get<float>();
  scan.scan_time = cdr.get<float>();
  scan.range_min = cdr.get<float>();
  scan.range_max = cdr.get<float>();
  scan.ranges.resize(cdr.get_count(sizeof(float)));
  for (float& range : scan.ranges) range = cdr.get<float>();
  cdr.get_count(sizeof(float));
  if (!cdr.good()) return std::nullopt;
  scan.time += duration_of(scan.time_increment, scan.ranges.size());
  return scan;
}

}  // namespace sf::record
