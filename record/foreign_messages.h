#pragma once
// Measurements of other programs in ROS 2 messages: sensor_msgs/Imu, NavSatFix, LaserScan and nav_msgs/Odometry.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sf::record {

/// The numbers of one message.
struct ForeignMessage {
  std::int64_t time = 0;       ///< [ns] stamp of its header
  std::vector<double> values;  ///< with the names of `foreign_columns`; of a scan, its ranges as in the message

  // For scans:
  double angle_min = 0.0, angle_max = 0.0;  ///< [rad]
  double range_min = 0.0, range_max = 0.0;  ///< [m]
};

/// Returns the names, with units, of the numbers of a message type:
///   Imu        rate_rad_s (about z), forward_m_s2, left_m_s2, up_m_s2
///   Odometry   x_m, y_m, yaw_rad, valid, the upper triangle of their covariance (NaN: not stated), forward_m_s,
///              left_m_s, turn_rad_s
///   NavSatFix  latitude_deg, longitude_deg (NaN: no fix), variance_m2: summed of both axes (NaN: not stated)
///   LaserScan  range_m
/// Empty: the type is not supported.
std::span<const std::string_view> foreign_columns(std::string_view type);

/// @param type with columns @param into its capacity is reused @return false for malformed bytes
bool decode_foreign(std::string_view type, std::span<const std::uint8_t> message, ForeignMessage& into);

}  // namespace sf::record
