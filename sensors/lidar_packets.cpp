#include "sensors/lidar_packets.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "sensors/laser.h"
#include "sensors/laser_packets.h"
#include "sensors/lidar.h"

namespace sf::sensors {

namespace {

constexpr std::size_t kBeamBytes[] = {0, 4, 6, 8, 0, 14};  ///< by numbers per beam
constexpr std::uint32_t kMostNumbers = 5;

std::uint32_t width_of(const SensorSpec& sensor) { return sensor.width != 0 ? sensor.width : kMostNumbers; }
std::uint32_t beams_per_part(std::uint32_t width) {
  return static_cast<std::uint32_t>((kPartBytes - kPartHeaderBytes) / kBeamBytes[width]);
}
std::uint32_t parts_of(std::uint32_t beams, std::uint32_t width) {
  return (beams + beams_per_part(width) - 1) / beams_per_part(width);
}
bool is_range(std::uint32_t column) { return column == 0 || column == 3; }

std::uint16_t word16(double value, double step) {
  return static_cast<std::uint16_t>(std::clamp(std::floor(value / step + 0.5), 0.0, 65535.0));
}

void put_beams(std::span<const double> values, std::uint32_t width, base::ByteWriter& out) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto column = static_cast<std::uint32_t>(i % width);
    if (is_range(column))
      out.put(extended_range_word(values[i]));
    else
      out.put(word16(values[i], column == 2 ? kIncidenceStep : kIntensityStep));
  }
}

void get_beams(base::ByteReader& in, LidarPart& part) {
  part.values.resize(std::size_t{part.count} * part.width);
  for (std::size_t i = 0; i < part.values.size(); ++i) {
    const auto column = static_cast<std::uint32_t>(i % part.width);
    part.values[i] = is_range(column) ? extended_range(in.get<std::uint32_t>())
                                      : in.get<std::uint16_t>() * (column == 2 ? kIncidenceStep : kIntensityStep);
  }
}

/// The form of lasers.
PayloadError read_ranges(std::span<const std::uint8_t> payload, bool extended, LidarPart& part) {
  LaserPart scan;
  const PayloadError fault = read_laser(payload, extended, scan);
  if (fault != PayloadError::none) return fault;
  part = {scan.total, scan.first, scan.count, scan.part, scan.parts, 1, {}};
  for (std::uint32_t i = 0; i < scan.count; ++i) part.values.push_back(range_of(scan, i));
  return PayloadError::none;
}

std::vector<double> first_ranges(const base::ReadingBlock& scan, std::uint32_t width) {
  std::vector<double> ranges;
  for (std::size_t i = 0; i < scan.values.size(); i += width) ranges.push_back(scan.values[i]);
  return ranges;
}

std::uint8_t lidar_form(std::uint8_t laser_type) {
  return laser_type == 0 ? 0 : static_cast<std::uint8_t>(laser_type - kLaser + kLidar);
}
std::uint8_t laser_form(std::uint8_t type) { return static_cast<std::uint8_t>(type - kLidar + kLaser); }

bool in_range(const LidarPart& part, double range_max) {
  for (std::size_t i = 0; range_max > 0.0 && i < part.values.size(); ++i) {
    const double value = part.values[i];
    if (is_range(static_cast<std::uint32_t>(i % part.width)) && std::isfinite(value) && value > range_max + 1e-3)
      return false;
  }
  return true;
}

}  // namespace

std::string lidar_wire_problem(const SensorSpec& sensor, WireFormat wire) {
  if (width_of(sensor) > 1 && wire == WireFormat::thesis)
    return "the thesis' layout has no intensities: leave out `intensity`, `incidence` and `returns`, or use the farm's "
           "packets (`--wire farm`)";
  return laser_wire_problem(sensor, wire);
}

std::uint32_t lidar_parts(const SensorSpec& sensor, WireFormat wire) {
  const std::uint32_t width = width_of(sensor);
  return width == 1 ? laser_parts(sensor, wire) : parts_of(sensor.elements, width);
}

std::uint8_t encode_lidar(const SensorSpec& sensor, const base::ReadingBlock& scan, WireFormat wire, std::uint32_t part,
                          base::Bytes& out) {
  const std::uint32_t width = width_of(sensor);
  if (width == 1) return lidar_form(encode_laser(sensor, scan, wire, part, out));
  SF_CHECK(scan.values.size() == std::size_t{width} * sensor.elements && part < lidar_parts(sensor, wire),
           "part " + std::to_string(part) + " of " + std::to_string(scan.values.size()) + " numbers");
  const std::uint32_t most = beams_per_part(width), first = part * most;
  const std::uint32_t count = std::min(most, sensor.elements - first);
  const auto mine = scan.values.subspan(std::size_t{first} * width, std::size_t{count} * width);
  if (std::ranges::any_of(mine, [](double value) { return std::isnan(value); })) return 0;
  base::ByteWriter writer(out);
  writer.put(sensor.elements);
  writer.put(first);
  writer.put(static_cast<std::uint16_t>(part));
  writer.put(static_cast<std::uint16_t>(lidar_parts(sensor, wire)));
  writer.put(static_cast<std::uint16_t>(count));
  writer.put(static_cast<std::uint16_t>(width - 1));
  put_beams(mine, width, writer);
  return kLidar + kExtended;
}

double lidar_wire_error(const SensorSpec& sensor, const base::ReadingBlock& scan) {
  const std::uint32_t width = width_of(sensor);
  if (width == 1) return laser_wire_error(sensor, scan);
  SensorSpec extended = sensor;
  extended.elements = std::max(sensor.elements, kPlainRays + 1);  // never plain
  base::ReadingBlock ranges = scan;
  const std::vector<double> first = first_ranges(scan, width);
  ranges.values = first;
  return laser_wire_error(extended, ranges);
}

PayloadError read_lidar(std::span<const std::uint8_t> payload, bool extended, LidarPart& part) {
  constexpr std::size_t kWidthAt = 14;
  const bool known = extended && payload.size() >= kPartHeaderBytes;
  const std::uint32_t more = known ? base::ByteReader(payload.subspan(kWidthAt)).get<std::uint16_t>() : 0;
  if (more == 0) return read_ranges(payload, extended, part);
  if (more + 1 > kMostNumbers || kBeamBytes[more + 1] == 0) return PayloadError::out_of_range;
  base::ByteReader in(payload);
  part = {.width = more + 1};
  part.total = in.get<std::uint32_t>(), part.first = in.get<std::uint32_t>();
  part.part = in.get<std::uint16_t>(), part.parts = in.get<std::uint16_t>(), part.count = in.get<std::uint16_t>();
  in.get<std::uint16_t>();
  const std::size_t size = kPartHeaderBytes + part.count * kBeamBytes[part.width];
  if (payload.size() != size) return payload.size() < size ? PayloadError::too_short : PayloadError::too_long;
  const std::uint32_t most = beams_per_part(part.width);
  if (part.total < 1 || part.total > kExtendedRays || part.parts != parts_of(part.total, part.width) ||
      part.part >= part.parts || part.first != part.part * most ||
      part.count != std::min(most, part.total - part.first))
    return PayloadError::out_of_range;
  get_beams(in, part);
  return PayloadError::none;
}

PayloadPart decode_lidar(const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t type,
                         WireFormat wire) {
  const bool extended = wire == WireFormat::farm && type == kLidar + kExtended;
  LidarPart scan;
  const PayloadError fault = read_lidar(payload, extended, scan);
  if (fault != PayloadError::none) return {.fault = fault};
  const bool any = sensor.elements == 0;
  if (scan.width == 1 && (any || width_of(sensor) == 1)) return decode_laser(sensor, payload, laser_form(type), wire);
  if (!any && (scan.total != sensor.elements || scan.width != width_of(sensor)))
    return {.fault = PayloadError::out_of_range};
  if (!in_range(scan, sensor.limit)) return {.fault = PayloadError::out_of_range};
  return {PayloadError::none, scan.count, scan.part, scan.parts};
}

void fill_lidar(const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t type, WireFormat wire,
                std::span<double> values) {
  if (width_of(sensor) == 1) return fill_laser(sensor, payload, laser_form(type), wire, values);
  LidarPart scan;
  const PayloadError fault = read_lidar(payload, true, scan);
  SF_CHECK(fault == PayloadError::none && std::size_t{scan.first + scan.count} * scan.width <= values.size(),
           "a payload of beams " + std::to_string(scan.first) + " to " + std::to_string(scan.first + scan.count));
  for (std::size_t i = 0; i < scan.values.size(); ++i)
    values[std::size_t{scan.first} * scan.width + i] =
        is_range(static_cast<std::uint32_t>(i % scan.width)) ? read_range(sensor, scan.values[i]) : scan.values[i];
}

}  // namespace sf::sensors
