#include "sensors/laneedge_packets.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "sensors/laneedge.h"
#include "sensors/wire_error.h"

namespace sf::sensors {

namespace {

constexpr std::size_t kFarmBytes = 12;
constexpr std::size_t kThesisBytes = 2;
constexpr double kMillimetre = 1e-3;  // [m] step of the distance

/// Returns the nearest integer multiple of `unit`, in [0, most]; `most` for NaN.
template <class Word>
Word in_units(double value, double unit, Word most) {
  if (std::isnan(value)) return most;
  return static_cast<Word>(std::clamp(std::floor(value / unit + 0.5), 0.0, static_cast<double>(most)));
}

/// Inverse of `in_units`; returns NaN if all bits are set.
template <class Word>
double from_units(Word word, double unit) {
  return word == std::numeric_limits<Word>::max() ? std::numeric_limits<double>::quiet_NaN() : word * unit;
}

}  // namespace

std::string lane_edge_wire_problem(const SensorSpec&, WireFormat) { return ""; }

std::uint32_t lane_edge_parts(const SensorSpec&, WireFormat) { return 1; }

std::uint8_t encode_lane_edge(const SensorSpec&, const base::ReadingBlock& reading, WireFormat wire, std::uint32_t part,
                              base::Bytes& out) {
  SF_CHECK(part == 0 && reading.values.size() == 4, "a lane edge reading is four numbers in one datagram");
  constexpr auto kMost32 = std::numeric_limits<std::uint32_t>::max();
  const double distance = reading.values[0];
  base::ByteWriter writer(out);
  writer.put(std::isnan(distance) ? kNoEdge : in_units<std::uint16_t>(distance, kMillimetre, kNoEdge - 1));
  if (wire == WireFormat::thesis) return kLaneEdge;
  writer.put(in_units<std::uint16_t>(reading.values[1], 1.0, 65'535));
  writer.put(in_units<std::uint32_t>(reading.values[2], 1e-6, kMost32));
  writer.put(in_units<std::uint32_t>(reading.values[3], 1e-6, kMost32));
  return kLaneEdge;
}

double lane_edge_wire_error(const SensorSpec&, const base::ReadingBlock& reading) {
  return wire_error(reading.values.first(1), 1, kMillimetre, 0.0, (kNoEdge - 1) * kMillimetre);
}

PayloadPart decode_lane_edge(const SensorSpec&, std::span<const std::uint8_t> payload, std::uint8_t type,
                             WireFormat wire) {
  const std::size_t bytes = wire == WireFormat::thesis ? kThesisBytes : kFarmBytes;
  PayloadPart part;
  part.elements = 1;
  if (wire == WireFormat::farm && type != kLaneEdge) part.fault = PayloadError::out_of_range;
  if (payload.size() < bytes) part.fault = PayloadError::too_short;
  if (payload.size() > bytes) part.fault = PayloadError::too_long;
  return part;
}

void read_lane_edge(const SensorSpec&, std::span<const std::uint8_t> payload, std::uint8_t, WireFormat wire,
                    std::span<double> values) {
  SF_CHECK(values.size() == 4, "a lane edge reading is four numbers");
  base::ByteReader reader(payload);
  values[0] = from_units(reader.get<std::uint16_t>(), kMillimetre);
  if (wire == WireFormat::thesis) return;
  values[1] = reader.get<std::uint16_t>();
  values[2] = from_units(reader.get<std::uint32_t>(), 1e-6);
  values[3] = from_units(reader.get<std::uint32_t>(), 1e-6);
}

}  // namespace sf::sensors
