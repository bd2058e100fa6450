#include "sensors/laser_packets.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "sensors/laser.h"
#include "sensors/wire_error.h"
#include "sensors/wire_limits.h"

namespace sf::sensors {

namespace {

constexpr double kPlainPerMetre = 1e3;
constexpr double kExtendedPerMetre = 1e4;
constexpr double kRangeSlack = 1e-3;  ///< [m] one unit of the coarser wire form

bool fits_plain(const SensorSpec& sensor) { return sensor.elements <= kPlainRays && sensor.limit <= kPlainRange; }

std::uint32_t parts_of(std::uint32_t rays) { return (rays + kPartRays - 1) / kPartRays; }

template <class Word>
Word to_word(double metres, double per_metre, Word largest) {
  const double units = metres * per_metre + 0.5;  // the conversion truncates
  if (!(units >= 1.0)) return 0;
  return units >= static_cast<double>(largest) ? largest : static_cast<Word>(units);
}

std::uint16_t plain_word(double metres) { return to_word<std::uint16_t>(metres, kPlainPerMetre, 0xFFFF); }

/// Returns the number of the largest word that encodes a range [m].
double largest_range(bool extended) { return extended ? (kNoReturn - 1) / kExtendedPerMetre : kPlainRange; }

/// A range_max that is unknown (0) or beyond the largest word has no word of its own.
WireLimits wire_limits(const SensorSpec& sensor, bool extended) {
  const auto rounded = [&](double metres) {
    return extended ? extended_range_word(metres) / kExtendedPerMetre : plain_word(metres) / kPlainPerMetre;
  };
  const bool has_word = sensor.limit > 0.0 && sensor.limit <= largest_range(extended);
  return {limits_of(sensor), {rounded(sensor.range_min), has_word ? rounded(sensor.limit) : HUGE_VAL}};
}

void put_plain(std::span<const double> ranges, base::ByteWriter& writer) {
  writer.put(static_cast<std::uint16_t>(ranges.size()));
  for (const double metres : ranges) writer.put(plain_word(metres));
}

void put_extended(std::uint32_t total, std::uint32_t part, std::span<const double> ranges, base::ByteWriter& writer) {
  writer.put(total);
  writer.put(part * kPartRays);
  writer.put(static_cast<std::uint16_t>(part));
  writer.put(static_cast<std::uint16_t>(parts_of(total)));
  writer.put(static_cast<std::uint16_t>(ranges.size()));
  writer.put(std::uint16_t{0});
  for (const double metres : ranges) writer.put(extended_range_word(metres));
}

bool has_nan(std::span<const double> ranges) {
  return std::any_of(ranges.begin(), ranges.end(), [](double metres) { return std::isnan(metres); });
}

PayloadError take_words(std::span<const std::uint8_t> rest, std::size_t word, LaserPart& scan) {
  if (rest.size() < scan.count * word) return PayloadError::too_short;
  if (rest.size() > scan.count * word) return PayloadError::too_long;
  scan.words = rest;
  return PayloadError::none;
}

PayloadError read_plain(std::span<const std::uint8_t> payload, LaserPart& scan) {
  base::ByteReader reader(payload);
  scan.total = scan.count = reader.get<std::uint16_t>();
  if (!reader.good()) return PayloadError::too_short;
  const PayloadError size = take_words(payload.subspan(reader.position()), 2, scan);
  if (size != PayloadError::none) return size;
  return scan.count >= 1 && scan.count <= kPlainRays ? PayloadError::none : PayloadError::out_of_range;
}

PayloadError read_extended(std::span<const std::uint8_t> payload, LaserPart& scan) {
  base::ByteReader reader(payload);
  scan.total = reader.get<std::uint32_t>();
  scan.first = reader.get<std::uint32_t>();
  scan.part = reader.get<std::uint16_t>();
  scan.parts = reader.get<std::uint16_t>();
  scan.count = reader.get<std::uint16_t>();
  reader.get<std::uint16_t>();  // reserved
  if (!reader.good()) return PayloadError::too_short;
  const PayloadError size = take_words(payload.subspan(reader.position()), 4, scan);
  if (size != PayloadError::none) return size;

  // The split is fixed: each field follows from the total and the part number, so a receiver's sums cannot overflow.
  if (scan.total < 1 || scan.total > kExtendedRays) return PayloadError::out_of_range;
  if (scan.parts != parts_of(scan.total) || scan.part >= scan.parts) return PayloadError::out_of_range;
  if (scan.first != scan.part * kPartRays) return PayloadError::out_of_range;
  return scan.count == std::min(kPartRays, scan.total - scan.first) ? PayloadError::none : PayloadError::out_of_range;
}

/// The plain form saturates: its largest word means "this or more".
bool plausible(const LaserPart& scan, double range_max) {
  if (range_max <= 0.0) return true;
  for (std::uint32_t i = 0; i < scan.count; ++i) {
    const double metres = range_of(scan, i);
    if (std::isinf(metres) || (!scan.extended && metres >= kPlainRange)) continue;
    if (metres > range_max + kRangeSlack) return false;
  }
  return true;
}

}  // namespace

std::uint32_t extended_range_word(double metres) {
  if (metres == std::numeric_limits<double>::infinity()) return kNoReturn;
  return to_word<std::uint32_t>(metres, kExtendedPerMetre, kNoReturn - 1);
}

double extended_range(std::uint32_t word) {
  return word == kNoReturn ? std::numeric_limits<double>::infinity() : word / kExtendedPerMetre;
}

double read_range(const SensorSpec& sensor, double metres) { return wire_limits(sensor, true).range(metres); }

std::string laser_wire_problem(const SensorSpec& sensor, WireFormat wire) {
  if (sensor.elements > kExtendedRays)
    return std::to_string(sensor.elements) + " samples, but a scan is sent with at most " +
           std::to_string(kExtendedRays) + ": lower `samples`";
  if (wire == WireFormat::farm || fits_plain(sensor)) return "";
  return std::to_string(sensor.elements) + " samples up to " + std::to_string(sensor.limit) +
         " m do not fit the thesis' layout, which holds 361 rays up to 65.535 m: lower `samples` or `range_max`, or "
         "use the farm's packets (`--wire farm`)";
}

std::uint32_t laser_parts(const SensorSpec& sensor, WireFormat wire) {
  return wire == WireFormat::thesis || fits_plain(sensor) ? 1 : parts_of(sensor.elements);
}

std::uint8_t encode_laser(const SensorSpec& sensor, const base::ReadingBlock& scan, WireFormat wire, std::uint32_t part,
                          base::Bytes& out) {
  const std::span<const double> ranges = scan.values;
  const auto total = static_cast<std::uint32_t>(ranges.size());
  SF_CHECK(total >= 1 && total == sensor.elements && total <= kExtendedRays && part < laser_parts(sensor, wire),
           "part " + std::to_string(part) + " of a scan of " + std::to_string(ranges.size()) + " rays, of " +
               std::to_string(sensor.elements) + " samples");
  const bool plain = fits_plain(sensor);
  SF_CHECK(plain || wire == WireFormat::farm, "a scan of " + std::to_string(total) + " rays in the thesis' layout");

  const auto mine = plain ? ranges : ranges.subspan(part * kPartRays, std::min(kPartRays, total - part * kPartRays));
  if (has_nan(mine)) return 0;
  base::ByteWriter writer(out);
  if (plain) {
    put_plain(mine, writer);
  } else {
    put_extended(total, part, mine, writer);
  }
  return plain ? kLaser : kLaser + kExtended;
}

double laser_wire_error(const SensorSpec& sensor, const base::ReadingBlock& scan) {
  const bool plain = fits_plain(sensor);
  const double step = 1.0 / (plain ? kPlainPerMetre : kExtendedPerMetre);
  return std::max(wire_error(scan.values, 1, step, 0.0, largest_range(!plain)),
                  wire_limits(sensor, !plain).error(scan.values, step));
}

PayloadPart decode_laser(const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t type,
                         WireFormat wire) {
  const bool extended = wire == WireFormat::farm && type == kLaser + kExtended;
  if (!extended && type != kLaser) return {.fault = PayloadError::out_of_range};
  LaserPart scan;
  PayloadPart part{.fault = read_laser(payload, extended, scan)};
  if (part.fault != PayloadError::none) return part;

  const bool whole = sensor.elements == 0 || scan.total == sensor.elements;
  if (!whole || !plausible(scan, sensor.limit)) return {.fault = PayloadError::out_of_range};
  part.elements = scan.count;
  part.part = scan.part;
  part.parts = scan.parts;
  return part;
}

void fill_laser(const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t type, WireFormat wire,
                std::span<double> values) {
  LaserPart scan;
  const PayloadError fault = read_laser(payload, wire == WireFormat::farm && type == kLaser + kExtended, scan);
  SF_CHECK(fault == PayloadError::none && scan.first + scan.count <= values.size(),
           "a payload of rays " + std::to_string(scan.first) + " to " + std::to_string(scan.first + scan.count) +
               " for a scan of " + std::to_string(values.size()));
  const WireLimits limits = wire_limits(sensor, scan.extended);
  const bool beyond = !scan.extended && limits.rounded.max < kPlainRange;
  for (std::uint32_t i = 0; i < scan.count; ++i) {
    const double metres = range_of(scan, i);
    const bool no_return = beyond && metres >= kPlainRange;
    values[scan.first + i] = no_return ? std::numeric_limits<double>::infinity() : limits.range(metres);
  }
}

PayloadError read_laser(std::span<const std::uint8_t> payload, bool extended, LaserPart& scan) {
  scan = {};
  scan.extended = extended;
  return extended ? read_extended(payload, scan) : read_plain(payload, scan);
}

double range_of(const LaserPart& scan, std::uint32_t i) {
  SF_CHECK(i < scan.count, "ray " + std::to_string(i) + " of " + std::to_string(scan.count));
  if (!scan.extended)
    return base::ByteReader(scan.words.subspan(2 * std::size_t{i})).get<std::uint16_t>() / kPlainPerMetre;
  return extended_range(base::ByteReader(scan.words.subspan(4 * std::size_t{i})).get<std::uint32_t>());
}

}  // namespace sf::sensors
