#include "record/standard_readings.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <vector>

#include "base/camera_pixels.h"
#include "base/echo.h"
#include "base/elementary.h"
#include "base/png.h"
#include "record/cdr.h"
#include "record/ros_messages.h"
#include "record/schemas.h"

namespace sf::record {

namespace {

using Message = StandardTopic::Message;

void put_range(CdrWriter& cdr, const StandardTopic& topic, std::span<const double> values) {
  // Infrared readings have a second column, the raw value.
  const std::size_t width = topic.infrared ? 2 : 1;
  const double range = values[width * topic.element];
  cdr.put(static_cast<std::uint8_t>(topic.infrared ? 1 : 0));
  cdr.put(static_cast<float>(topic.fov));
  cdr.put(base::float_below(topic.range_min));
  cdr.put(base::float_above(topic.range_max));
  cdr.put(base::rep117_range(range, {topic.range_min, topic.range_max}));
  cdr.put(0.0F);  // variance: unknown
}

/// Writes the covariance of a vector with independent axes; zeros if it is unknown.
void put_variances(CdrWriter& cdr, double x, double y, double z) {
  for (const double term : {x, 0.0, 0.0, 0.0, y, 0.0, 0.0, 0.0, z}) cdr.put(term);
}

/// Writes a vector of the sensor in the topic's frame, and the variance of each axis.
void put_turned(CdrWriter& cdr, const StandardTopic& topic, std::span<const double> vector, double sigma) {
  const glm::dvec3 v = topic.R_FS * glm::dvec3{vector[0], vector[1], vector[2]};
  for (const double part : {v.x, v.y, v.z}) cdr.put(part);
  put_variances(cdr, sigma * sigma, sigma * sigma, sigma * sigma);
}

void put_field(CdrWriter& cdr, const StandardTopic& topic, std::span<const double> values) {
  const std::span<const double> element = values.subspan(4 * topic.element, 4);  // the magnitude first
  if (topic.spatial) return put_turned(cdr, topic, element.subspan(1), topic.sigma);
  for (std::size_t axis = 1; axis < 4; ++axis) cdr.put(element[axis]);
  put_zeros(cdr, 9);
}

struct Degrees {
  double latitude = 0.0, longitude = 0.0;
};

/// Returns the position on the ellipsoid above a point of the plane that touches it at (0, 0), where east is Earth's y
/// axis and north its z axis. Exact.
Degrees degrees_at(double east, double north) {
  constexpr double a = 6378137.0, b = 6356752.314245;  // [m] semi-axes of WGS84
  const double up = a * std::sqrt(std::max(0.0, 1.0 - (east / a) * (east / a) - (north / b) * (north / b)));
  const double from_axis = base::hypot(up, east);
  return {base::atan2(a * a * north, b * b * from_axis) * 180.0 / M_PI, base::atan2(east, up) * 180.0 / M_PI};
}

void put_fix(CdrWriter& cdr, const StandardTopic& topic, std::span<const double> values) {
  constexpr std::uint16_t kGps = 1;
  const bool fix = std::isfinite(values[0]);
  const Degrees at = fix ? degrees_at(values[0], values[1]) : Degrees{values[0], values[0]};
  cdr.put(static_cast<std::int8_t>(fix ? 0 : -1));
  cdr.put(kGps);
  cdr.put(at.latitude);
  cdr.put(at.longitude);
  cdr.put(topic.spatial ? values[4] : std::numeric_limits<double>::quiet_NaN());  // NaN: not measured
  if (topic.sigma > 0.0 && fix) {
    constexpr double kUnmeasured = 1e6;                                            // [m^2] of the altitude
    const double error = topic.sigma * values[2], variance = 0.5 * error * error;  // HDOP refers to both axes together
    const double up = topic.spatial ? topic.sigma * values[5] : 0.0;
    put_variances(cdr, variance, variance, topic.spatial ? up * up : kUnmeasured);
    return cdr.put(std::uint8_t{1});  // approximated
  }
  put_zeros(cdr, 9);
  cdr.put(std::uint8_t{0});  // covariance: unknown
}

/// Writes nine numbers; the first marks the quantity as not measured.
void put_unmeasured(CdrWriter& cdr) {
  cdr.put(-1.0);
  put_zeros(cdr, 8);
}

/// Writes the orientation of the topic's frame, whose covariance is unknown, if the device estimates it.
void put_orientation(CdrWriter& cdr, const StandardTopic& topic, std::span<const double> q_WS) {
  const bool known = q_WS.size() == 4 && std::isfinite(q_WS[0]);
  glm::dquat q(1.0, 0.0, 0.0, 0.0);
  if (known) q = glm::dquat(q_WS[0], q_WS[1], q_WS[2], q_WS[3]) * glm::conjugate(glm::quat_cast(topic.R_FS));
  for (const double part : {q.x, q.y, q.z, q.w}) cdr.put(part);
  known ? put_zeros(cdr, 9) : put_unmeasured(cdr);
}

void put_imu(CdrWriter& cdr, const StandardTopic& topic, std::span<const double> values) {
  put_orientation(cdr, topic, values.subspan(std::min<std::size_t>(values.size(), 7)));
  const double variance = topic.sigma * topic.sigma, fixed = variance > 0.0 ? kLeastVariance : 0.0;
  if (!topic.spatial) {
    for (const double rate : {0.0, 0.0, values[0]}) cdr.put(rate);
    put_variances(cdr, fixed, fixed, variance);
    put_zeros(cdr, 3);
    return put_unmeasured(cdr);
  }
  put_turned(cdr, topic, values.first(3), topic.sigma);
  put_turned(cdr, topic, values.subspan(3, 3), topic.force_sigma);
}

/// Speeds of radar_msgs are positive where the range grows.
void put_radar_scan(CdrWriter& cdr, const StandardTopic& topic, std::span<const double> values) {
  std::vector<float> returns;
  for (std::size_t i = 0; i < values.size() && std::isfinite(values[i]); i += 4) {
    const auto [sa, ca] = base::sin_cos(values[i + 1]);
    const auto [se, ce] = base::sin_cos(values[i + 3]);
    const glm::dvec3 d = topic.R_FS * glm::dvec3{ce * ca, ce * sa, se};
    const double azimuth = base::atan2(d.y, d.x), elevation = base::atan2(d.z, base::hypot(d.x, d.y));
    constexpr double kAmplitude = 0.0;  // [dB] not modelled
    for (const double number : {values[i], azimuth, elevation, -values[i + 2], kAmplitude})
      returns.push_back(static_cast<float>(number));
  }
  cdr.put_count(returns.size() / 5);
  for (const float number : returns) cdr.put(number);
}

void put_map(CdrWriter& cdr, const StandardTopic& topic, std::int64_t time, std::span<const double> values) {
  const maps::GridGeometry& grid = topic.grid;
  const std::int64_t columns = maps::columns(grid), rows = maps::rows(grid);
  cdr.put(static_cast<std::int32_t>(time / 1'000'000'000));
  cdr.put(static_cast<std::uint32_t>(time % 1'000'000'000));
  cdr.put(static_cast<float>(grid.cell));
  cdr.put(static_cast<std::uint32_t>(columns));
  cdr.put(static_cast<std::uint32_t>(rows));
  put_pose(cdr, {grid.left, grid.top - static_cast<double>(rows) * grid.cell, 0.0, 0.0});
  cdr.put_count(static_cast<std::size_t>(columns * rows));
  constexpr std::int8_t kShown[4] = {-1, 100, 0, -1};  // indexed by maps::Cell
  for (std::int64_t row = rows - 1; row >= 0; --row)   // a ROS map begins at its lower left
    for (std::int64_t column = 0; column < columns; ++column) {
      const auto word = static_cast<std::uint32_t>(
          values[static_cast<std::size_t>(row / 4) * grid.word_columns + static_cast<std::size_t>(column / 4)]);
      cdr.put(kShown[(word >> maps::OccupancyGrid::shift_of({column, row})) & 3u]);
    }
}

constexpr std::uint8_t kUint16 = 4, kFloat32 = 7;  // PointField's datatypes

struct PointField {
  const char* name;
  std::uint8_t type;
};

/// The fields that drivers of lidars publish, those that the sensor has.
std::vector<PointField> point_fields(const StandardTopic& topic) {
  std::vector<PointField> fields{{"x", kFloat32}, {"y", kFloat32}, {"z", kFloat32}};
  if (topic.width > 1) fields.push_back({"intensity", kFloat32});
  fields.push_back({"ring", kUint16});
  if (topic.times != nullptr) fields.push_back({"time", kFloat32});
  return fields;
}

/// Organized cloud: one row per ring. A beam without an echo in the limits is NaN. Its points are as long as a multiple
/// of two bytes, and of four without times.
void put_points(CdrWriter& cdr, const StandardTopic& topic, std::span<const double> values) {
  const auto count = static_cast<std::uint32_t>(values.size() / topic.width), columns = count / topic.rings;
  const std::vector<PointField> fields = point_fields(topic);
  cdr.put(topic.rings), cdr.put(columns);
  cdr.put_count(fields.size());
  std::uint32_t bytes = 0;
  for (const PointField& field : fields) {
    cdr.put(std::string_view(field.name));
    cdr.put(bytes), cdr.put(field.type), cdr.put(std::uint32_t{1});
    bytes += field.type == kUint16 ? 2 : 4;
  }
  const bool padded = topic.times == nullptr;
  if (padded) bytes += 2;
  cdr.put(std::uint8_t{0});  // little-endian
  cdr.put(bytes), cdr.put(bytes * columns);
  cdr.put_count(std::size_t{bytes} * count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const double range = values[i * topic.width];
    const bool echo = base::echo_of(range, {topic.range_min, topic.range_max}) == base::Echo::valid;
    const glm::dvec3 p = (echo ? range : std::nan("")) * (*topic.directions)[i];
    cdr.put_packed(static_cast<float>(p.x)), cdr.put_packed(static_cast<float>(p.y)),
        cdr.put_packed(static_cast<float>(p.z));
    if (topic.width > 1) cdr.put_packed(static_cast<float>(values[i * topic.width + 1]));
    cdr.put_packed(static_cast<std::uint16_t>(i / columns));
    if (topic.times != nullptr) cdr.put_packed(static_cast<float>((*topic.times)[i]));
    if (padded) cdr.put_packed(std::uint16_t{0});
  }
  cdr.put(std::uint8_t{0});  // is_dense: points may be NaN
}

/// Writes an image up to its data. @param bytes per pixel
void put_image_header(CdrWriter& cdr, const StandardTopic& topic, std::string_view encoding, std::uint32_t bytes) {
  cdr.put(topic.rows), cdr.put(topic.columns);
  cdr.put(encoding);
  cdr.put(std::uint8_t{0});  // little-endian
  cdr.put(bytes * topic.columns);
  cdr.put_count(std::size_t{bytes} * topic.columns * topic.rows);
}

void put_depth_image(CdrWriter& cdr, const StandardTopic& topic, std::span<const double> values) {
  put_image_header(cdr, topic, "32FC1", sizeof(float));
  for (std::size_t i = 0; i < values.size(); i += topic.width)
    cdr.put_packed(base::rep117_range(values[i], {topic.range_min, topic.range_max}));
}

std::string_view encoding_of(const StandardTopic& topic) { return topic.mono ? "mono8" : "rgb8"; }

void put_color_image(CdrWriter& cdr, const StandardTopic& topic, std::span<const double> values) {
  put_image_header(cdr, topic, encoding_of(topic), topic.mono ? 1 : 3);
  for (const std::uint8_t part : base::image_bytes(values, topic.width, topic.mono)) cdr.put_packed(part);
}

void put_file(CdrWriter& cdr, std::string_view header, std::string_view file) {
  cdr.put_count(header.size() + file.size());
  for (const std::string_view part : {header, file})
    for (const char byte : part) cdr.put_packed(byte);
}

/// Millimetres, since inverse depths, which the plug-in makes of 32FC1, would be exact to 1 % only.
void put_depth_png(CdrWriter& cdr, const StandardTopic& topic, std::span<const double> values) {
  cdr.put(std::string_view("16UC1; compressedDepth png"));
  put_file(
      cdr, std::string(12, '\0'),  // of the plug-in, with parameters of inverse depths
      base::encode_png(base::millimetre_depths(values, topic.width, {topic.range_min, topic.range_max}),
                       static_cast<int>(topic.columns), static_cast<int>(topic.rows), base::PngContent::photograph));
}

/// The plug-in's readers decode files of colours as blue, green and red, and make rgb8 of them.
void put_color_file(CdrWriter& cdr, const StandardTopic& topic, std::span<const double> values) {
  cdr.put(std::string(encoding_of(topic)) + (topic.jpeg > 0 ? "; jpeg" : "; png") + " compressed " +
          (topic.mono ? "mono8" : "bgr8"));
  put_file(cdr, "", base::color_file(values, topic.width, {topic.columns, topic.rows, topic.mono, topic.jpeg}));
}

void put_camera_info(CdrWriter& cdr, const StandardTopic& topic) {
  const base::Lens& lens = topic.lens;
  const auto& k = lens.distortion;
  const bool rational = k[5] != 0.0 || k[6] != 0.0 || k[7] != 0.0;
  cdr.put(topic.rows), cdr.put(topic.columns);
  cdr.put(std::string_view(lens.fisheye ? "equidistant" : rational ? "rational_polynomial" : "plumb_bob"));
  const std::size_t count = lens.fisheye ? 4 : rational ? 8 : 5;
  cdr.put_count(count);
  for (std::size_t i = 0; i < count; ++i) cdr.put(k[i]);
  for (const double n : {lens.focal.x, 0.0, lens.center.x, 0.0, lens.focal.y, lens.center.y, 0.0, 0.0, 1.0}) cdr.put(n);
  for (const double n : {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}) cdr.put(n);
  for (const double n :
       {lens.focal.x, 0.0, lens.center.x, 0.0, 0.0, lens.focal.y, lens.center.y, 0.0, 0.0, 0.0, 1.0, 0.0})
    cdr.put(n);
  for (int i = 0; i < 6; ++i) cdr.put(std::uint32_t{0});  // binning, region of interest: the whole image
  cdr.put(std::uint8_t{0});
}

}  // namespace

std::string_view type_of(Message message) {
  switch (message) {
    case Message::range:
      return kRange;
    case Message::magnetic_field:
      return kMagneticField;
    case Message::fix:
      return kNavSatFix;
    case Message::imu:
      return kImu;
    case Message::map:
      return kOccupancyGrid;
    case Message::points:
      return kPointCloud;
    case Message::radar_scan:
      return kRadarScan;
    case Message::depth_image:
    case Message::color_image:
      return kImage;
    case Message::depth_png:
    case Message::color_file:
      return kCompressedImage;
    case Message::camera_info:
      return kCameraInfo;
  }
  return {};
}

void encode_standard(const StandardTopic& topic, std::int64_t time, std::span<const double> values, base::Bytes& out) {
  CdrWriter cdr(out);
  put_header(cdr, time, topic.frame);
  switch (topic.message) {
    case Message::range:
      return put_range(cdr, topic, values);
    case Message::magnetic_field:
      return put_field(cdr, topic, values);
    case Message::fix:
      return put_fix(cdr, topic, values);
    case Message::imu:
      return put_imu(cdr, topic, values);
    case Message::map:
      return put_map(cdr, topic, time, values);
    case Message::points:
      return put_points(cdr, topic, values);
    case Message::radar_scan:
      return put_radar_scan(cdr, topic, values);
    case Message::depth_image:
      return put_depth_image(cdr, topic, values);
    case Message::color_image:
      return put_color_image(cdr, topic, values);
    case Message::depth_png:
      return put_depth_png(cdr, topic, values);
    case Message::color_file:
      return put_color_file(cdr, topic, values);
    case Message::camera_info:
      return put_camera_info(cdr, topic);
  }
}

}  // namespace sf::record
