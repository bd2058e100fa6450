#include "sensors/occupancy_packets.h"

#include <fmt/format.h>

#include "base/error.h"
#include "maps/map_packets.h"
#include "sensors/occupancy.h"

namespace sf::sensors {

namespace {

maps::GridGeometry plan_of(const SensorSpec& sensor, const Pose& corner) {
  return {corner.x, corner.y, sensor.pitch, sensor.across, sensor.elements / sensor.across};
}

PayloadError fault_of(maps::PartFault fault) {
  switch (fault) {
    case maps::PartFault::none:
      return PayloadError::none;
    case maps::PartFault::too_short:
      return PayloadError::too_short;
    case maps::PartFault::too_long:
      return PayloadError::too_long;
    case maps::PartFault::out_of_range:
      break;
  }
  return PayloadError::out_of_range;
}

void put_plain(const SensorSpec& sensor, std::span<const double> words, std::uint32_t part, base::Bytes& out) {
  const std::uint32_t half = maps::plain_half(sensor.elements);
  base::ByteWriter writer(out);
  if (part == 0) writer.put(static_cast<std::uint8_t>(sensor.elements / sensor.across));
  if (part == 0) writer.put(static_cast<std::uint8_t>(sensor.across));
  for (const double word : part == 0 ? words.first(half) : words.subspan(half))
    writer.put(static_cast<std::uint32_t>(word));
}

PayloadPart decode_plain(const SensorSpec& sensor, std::span<const std::uint8_t> payload) {
  maps::PlainPart part;
  const maps::PartFault fault = maps::read_plain(payload, part);
  if (fault != maps::PartFault::none) return {.fault = fault_of(fault)};
  const std::uint32_t half = maps::plain_half(sensor.elements);
  const std::uint32_t expected = part.second ? sensor.elements - half : half;
  const bool shaped =
      part.second || (part.word_columns == sensor.across && part.word_rows * part.word_columns == sensor.elements);
  if (sensor.elements != 0 && (part.count != expected || !shaped)) return {.fault = PayloadError::out_of_range};
  return {PayloadError::none, part.count, part.second ? 1u : 0u, occupancy_parts(sensor, WireFormat::thesis)};
}

}  // namespace

std::string occupancy_wire_problem(const SensorSpec& sensor, WireFormat wire) {
  if (wire == WireFormat::farm) return "";
  const std::uint32_t rows = sensor.elements / sensor.across;
  const bool fits =
      sensor.elements <= maps::kMaxPlainWords && sensor.across <= maps::kMaxPlainSide && rows <= maps::kMaxPlainSide;
  if (fits) return "";
  return fmt::format(
      "a map of {} x {} words does not fit the thesis' layout, which holds {} words, at most {} in a row or column: "
      "lower `words`, or use the farm's packets (`--wire farm`)",
      sensor.across, rows, maps::kMaxPlainWords, maps::kMaxPlainSide);
}

std::uint32_t occupancy_parts(const SensorSpec& sensor, WireFormat wire) {
  if (wire == WireFormat::thesis) return sensor.elements == 1 ? 1 : 2;
  return maps::parts_of(sensor.elements);
}

std::uint8_t encode_occupancy(const SensorSpec& sensor, const base::ReadingBlock& reading, WireFormat wire,
                              std::uint32_t part, base::Bytes& out) {
  SF_CHECK(reading.values.size() == sensor.elements && part < occupancy_parts(sensor, wire) && sensor.across > 0,
           fmt::format("part {} of a map of {} words, of {}", part, reading.values.size(), sensor.elements));
  if (wire == WireFormat::thesis) {
    put_plain(sensor, reading.values, part, out);
    return kOccupancy;
  }
  maps::put_part(
      plan_of(sensor, reading.X_WS), part, reading.flags & maps::kTruePoses,
      [&](std::uint32_t i) { return static_cast<std::uint32_t>(reading.values[i]); }, out);
  return kOccupancy;
}

PayloadPart decode_occupancy(const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t type,
                             WireFormat wire) {
  if (type != kOccupancy) return {.fault = PayloadError::out_of_range};
  if (wire == WireFormat::thesis) return decode_plain(sensor, payload);
  maps::MapPart part;
  const maps::PartFault fault = maps::read_part(payload, part);
  if (fault != maps::PartFault::none) return {.fault = fault_of(fault)};
  const bool mine =
      sensor.elements == 0 || (maps::words(part.geometry) == sensor.elements &&
                               part.geometry.word_columns == sensor.across && part.geometry.cell == sensor.pitch);
  if (!mine) return {.fault = PayloadError::out_of_range};
  return {PayloadError::none, part.count, part.part, part.parts};
}

void read_occupancy(const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t, WireFormat wire,
                    std::span<double> values) {
  if (wire == WireFormat::thesis) {
    maps::PlainPart part;
    maps::read_plain(payload, part);
    const std::uint32_t first = part.second ? maps::plain_half(sensor.elements) : 0;
    for (std::uint32_t i = 0; i < part.count && first + i < values.size(); ++i)
      values[first + i] = maps::word_of(part, i);
    return;
  }
  maps::MapPart part;
  maps::read_part(payload, part);
  for (std::uint32_t i = 0; i < part.count && part.first + i < values.size(); ++i)
    values[part.first + i] = maps::word_of(part, i);
}

}  // namespace sf::sensors
