#include "bridges/player/readings.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "base/elementary.h"
#include "sensors/fiducial.h"
#include "sensors/infrared.h"
#include "sensors/sensor_type.h"

namespace sf::bridges::player {

namespace {

/// [m] Player's ranges are finite and within the sensor's limits; NaN becomes the maximum. A valid range is below the
/// maximum as it is sent, also in float32.
template <class Number>
Number clean(double range, const base::RangeLimits& limits) {
  const auto most = static_cast<Number>(limits.max);
  if (std::isnan(range) || range >= limits.max) return most;
  const auto nearest = static_cast<Number>(std::max(range, limits.min));
  return nearest < most ? nearest : std::nextafter(most, Number{0});
}

/// Returns the number of values per element, of which the first is the range.
std::size_t width_of(const Device& device) { return device.type == sensors::kInfrared ? sensors::kInfraredColumns : 1; }

template <class Number>
void put_ranges(const Device& device, const LastReading& reading, XdrWriter& xdr) {
  const std::size_t width = width_of(device);
  xdr.put_count(reading.values.size() / width);
  for (std::size_t i = 0; i < reading.values.size(); i += width)
    xdr.put(clean<Number>(reading.values[i], limits_of(*device.sensor)));
}

void put_scan(const Device& device, const LastReading& reading, XdrWriter& xdr) {
  constexpr std::size_t kAngles = 16;  // [byte] a scan starts like its configuration: angles and maximum range
  xdr.put_bytes(std::span(device.config).first(kAngles));
  put_ranges<float>(device, reading, xdr);
  xdr.put_opaque(
      base::Bytes(reading.values.size()));  // intensities, which some clients print without checking their count
  xdr.put(reading.sequence);
}

/// Player's drivers leave the conversion from a sensor's voltage to the robot. Here the voltage is that of a 5 V
/// analogue output.
void put_infrared(const Device& device, const LastReading& reading, XdrWriter& xdr) {
  constexpr double kVolts = 5.0 / sensors::kMostResponse;
  const std::vector<double>& values = reading.values;
  xdr.put_count(values.size() / sensors::kInfraredColumns);
  for (std::size_t i = 1; i < values.size(); i += sensors::kInfraredColumns)
    xdr.put(static_cast<float>(kVolts * values[i]));
  put_ranges<float>(device, reading, xdr);
}

void put_bumpers(const LastReading& reading, XdrWriter& xdr) {
  base::Bytes pressed;
  for (const double value : reading.values) pressed.push_back(value > 0.5 ? 1 : 0);
  xdr.put_opaque(pressed);
}

/// Poses in the finder's frame, their uncertainties 0; as in Player, a fiducial that cannot be identified has id -1.
void put_fiducials(const LastReading& reading, XdrWriter& xdr) {
  constexpr std::size_t kWidth = sensors::kFiducialNumbers;
  std::size_t count = 0;
  while (count * kWidth < reading.values.size() && !std::isnan(reading.values[count * kWidth])) ++count;
  xdr.put_count(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double* const row = &reading.values[i * kWidth];
    const glm::dvec2 p = row[2] * base::rotate(row[3], {1.0, 0.0});
    xdr.put(row[0] > 0.0 ? static_cast<std::int32_t>(row[0]) : -1);
    put_pose({p.x, p.y, 0.0, row[4]}, xdr);
    put_pose({}, xdr);
  }
}

/// @param per [1/unit] integers per unit of `value`
std::int32_t whole(double value, double per) {
  constexpr double kMost = 2'147'483'647.0;
  return std::isfinite(value) ? static_cast<std::int32_t>(std::clamp(std::round(value * per), -kMost, kMost)) : 0;
}

/// A world has no position on the Earth. Its origin is at 0 degrees north and east, and UTM coordinates are x and y in
/// centimetres, the unit used by Player's drivers and clients. Without a fix the position is 0.
void put_gps(const LastReading& reading, const base::Report& report, XdrWriter& xdr) {
  constexpr double kNorth = 110'574.3, kEast = 111'319.5;  // [m] per degree at the equator, WGS84
  const double x = reading.values[0], y = reading.values[1];
  const bool fix = std::isfinite(x) && std::isfinite(y);
  const glm::dvec2 v = base::rotate(report.X_WM.yaw, {report.velocity.forward, report.velocity.left});
  xdr.put(static_cast<std::uint32_t>(reading.time / 1'000'000'000));
  xdr.put(static_cast<std::uint32_t>(reading.time % 1'000'000'000 / 1000));
  xdr.put_all({whole(y / kNorth, 1e7), whole(x / kEast, 1e7), whole(reading.height, 1e3)});
  xdr.put_all({glm::length(v), base::atan2(v.y, v.x)});
  for (const double position : {x, y}) xdr.put(fix ? std::round(100.0 * position) : 0.0);
  xdr.put(fix ? 1u : 0u);
  xdr.put_all({whole(reading.values[3], 1.0), whole(reading.values[2], 10.0), 0});
  xdr.put_all({0.0, 0.0});  // errors in metres are unknown
}

/// Little-endian, unlike XDR, so that programs for common processors copy it into their variables.
template <class Number>
void put_little(Number number, base::Bytes& out) {
  const auto bits = std::bit_cast<std::array<std::uint8_t, sizeof(Number)>>(number);
  static_assert(std::endian::native == std::endian::little);
  out.insert(out.end(), bits.begin(), bits.end());
}

void put_opaque_reading(const Device& device, const LastReading& reading, XdrWriter& xdr) {
  const auto width = static_cast<std::uint32_t>(sensors::element_width(*sensors::find_sensor_type(device.type)));
  base::Bytes bytes;
  const auto rows = static_cast<std::uint32_t>(reading.values.size() / width);
  for (const std::uint32_t number : {std::uint32_t{device.type}, reading.sequence, rows, width})
    put_little(number, bytes);
  for (const double value : reading.values) put_little(value, bytes);
  xdr.put_opaque(bytes);
}

}  // namespace

std::uint32_t data_subtype(const Device& device, bool stamped) {
  return stamped && device.interf == Interface::ranger ? ranger_data::stamped : ranger_data::ranges;
}

void put_reading(const Device& device, const LastReading& reading, const base::Report& report, bool stamped,
                 XdrWriter& xdr) {
  if (device.interf == Interface::laser) put_scan(device, reading, xdr);
  if (device.interf == Interface::sonar) put_ranges<float>(device, reading, xdr);
  if (device.interf == Interface::ir) put_infrared(device, reading, xdr);
  if (device.interf == Interface::bumper) put_bumpers(reading, xdr);
  if (device.interf == Interface::fiducial) put_fiducials(reading, xdr);
  if (device.interf == Interface::gps) put_gps(reading, report, xdr);
  if (device.interf == Interface::opaque) put_opaque_reading(device, reading, xdr);
  if (device.interf != Interface::ranger) return;
  put_ranges<double>(device, reading, xdr);
  if (!stamped) return;
  xdr.put(1u);
  xdr.put_bytes(device.geometry);
  xdr.put(1u);
  xdr.put_bytes(device.config);
}

void put_state(const base::Pose& X_OM, const base::Report& report, bool stalled, XdrWriter& xdr) {
  put_pose2d(X_OM, xdr);
  xdr.put_all({report.velocity.forward, report.velocity.left, report.velocity.turn});
  xdr.put(stalled ? 1u : 0u);
}

void put_pose2d(const base::Pose& pose, XdrWriter& xdr) { xdr.put_all({pose.x, pose.y, base::wrap_angle(pose.yaw)}); }

}  // namespace sf::bridges::player
