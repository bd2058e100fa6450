#pragma once
// Elements of readings as standard ROS messages: ranges, magnetic fields, GPS fixes, yaw rates, occupancy maps, clouds,
// images.

#include <cstdint>
#include <span>

#include "base/bytes.h"
#include "record/run_info.h"

namespace sf::record {

/// Returns the ROS type of the topic's messages.
std::string_view type_of(StandardTopic::Message message);

/// Appends one message. Marks quantities that a sensor does not measure as unknown, as each message defines it: an
/// orientation or an acceleration (covariance -1), the covariance of a fix (type 0).
///   range           range_m as defined by base::rep117_range; the limits are rounded outwards
///   magnetic_field  vector_T [T]; of a compass in `topic.frame`, with the variance of each axis
///   fix             x_m, y_m on a plane that touches WGS84 at latitude 0 and longitude 0, x east, y north; NaN: no
///                   fix; half of (sigma hdop)^2 as the variance of each axis; with an altitude, altitude_m above that
///                   plane and (sigma vdop)^2
///   imu             rate_rad_s of a gyro about z, and its variance; or the rates and forces of an imu in
///                   `topic.frame`, and the variance of each axis
///   map             words (maps/grid.h): -1 unexplored, 0 free, 100 occupied
///   depth_image     32FC1 [m] along the optical axis; +infinity without a surface before range_max, -infinity for one
///                   that is too near (REP 118)
///   color_image     rgb8, or mono8 of grey colours
///   depth_png       CompressedImage as of compressed_depth_image_transport: 16UC1 [mm] as PNG after a header of twelve
///                   bytes; 0 without a surface, too near, or from 65.5355 m
///   color_file      CompressedImage as of compressed_image_transport: the same as PNG or JPEG
///   camera_info     of the distorted images; P is K, as nothing is rectified
/// @param time [ns] of the measurement
/// @param values of the whole reading, with a range below `range_min` for a surface that is too near; in the layout of
/// the sensor type of `topic`
void encode_standard(const StandardTopic& topic, std::int64_t time, std::span<const double> values, base::Bytes& out);

}  // namespace sf::record
