#pragma once
// The ROS messages of a recording as CDR. Every `encode` appends one whole message to `out`. Units and frames follow
// REP 103, names follow REP 105. Time is simulated, [ns] >= 0.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/bytes.h"
#include "base/echo.h"
#include "base/pose.h"
#include "base/state_quality.h"
#include "record/cdr.h"
#include "record/odometry.h"

namespace sf::record {

/// Writes and reads a builtin_interfaces/Time. @param time [ns] >= 0
void put_time(CdrWriter& cdr, std::int64_t time);
std::int64_t get_time(CdrReader& cdr);
/// Writes time stamp and frame, the first fields of every message. @param time [ns] >= 0
void put_header(CdrWriter& cdr, std::int64_t time, std::string_view frame);
/// Reads both. @param time out: [ns] @return the frame
std::string get_header(CdrReader& cdr, std::int64_t& time);

/// Pose of one frame in another.
struct Transform {
  std::int64_t time = 0;  ///< [ns]
  std::string_view parent;
  std::string_view child;
  base::Pose X_PC;
  base::Tilt tilt = {};  ///< of the child after X_PC
};

/// One planar scan.
struct Scan {
  std::int64_t time = 0;   ///< [ns] time of the measurement
  std::string frame;       ///< frame of the sensor: x along bearing 0
  float fov = 0.0F;        ///< [rad] bearings range from -fov/2 to +fov/2, inclusive; a single sample has bearing 0
  float scan_time = 0.0F;  ///< [s] time between scans
  float time_increment = 0.0F;  ///< [s] between beams of a rolling scan, whose last is cast at `time`; else 0
  double range_min = 0.0;       ///< [m]
  double range_max = 0.0;       ///< [m]
  std::vector<float> ranges;    ///< [m] one per sample, as defined by base::rep117_range
};

/// Writes position and orientation, the quaternion (x, y, z, w).
void put_pose(CdrWriter& cdr, const base::Pose& pose, const base::Tilt& tilt = {});
/// Writes `count` zeros, for example for a covariance that is zero or unknown.
void put_zeros(CdrWriter& cdr, int count);

/// @param velocity in the child frame
void encode_odometry(const Transform& transform, const base::Twist& velocity, const OdometryCovariance& covariance,
                     base::Bytes& out);

void encode_twist(std::int64_t time, std::string_view frame, const base::Twist& twist, base::Bytes& out);

void encode_transforms(std::span<const Transform> transforms, base::Bytes& out);

/// Rounds the message's limits outwards, so that each valid range is at least `range_min` and less than `range_max`.
/// @param ranges [m] one per sample: `range_max` or more without an echo, less than `range_min` for a surface that is
/// too near. `scan.ranges` is not used.
void encode_scan(const Scan& scan, std::span<const double> ranges, base::Bytes& out);

/// Encodes the simulated time, for nodes that use it.
void encode_clock(std::int64_t time, base::Bytes& out);

/// Encodes the quality of a mover's state at `time`: its age in s, and the covariance of x, y [m] and yaw [rad] as in
/// base::StateQuality.
/// @param frame of the mover
void encode_state_quality(std::int64_t time, std::string_view frame, const base::StateQuality& quality,
                          base::Bytes& out);

/// @return nullopt if the bytes are not a LaserScan. The limits are those of the message; the fov of one sample is 0.
std::optional<Scan> decode_scan(std::span<const std::uint8_t> message);

}  // namespace sf::record
