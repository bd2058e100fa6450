#include "sensors/magnetometer_packets.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "sensors/magnetometer.h"
#include "sensors/wire_error.h"

namespace sf::sensors {

namespace {

constexpr double kUnit = 1e-8;            // [T] 1e-4 Gauss
constexpr std::size_t kMagnetHeader = 4;  // [bytes]
constexpr std::size_t kMagnetWord = 4;    // [bytes]

using Word = std::int32_t;
constexpr Word kLeast = std::numeric_limits<Word>::min();
constexpr Word kMost = std::numeric_limits<Word>::max();

Word to_word(double tesla) {
  return static_cast<Word>(std::clamp(std::round(tesla / kUnit), 1.0 * kLeast, 1.0 * kMost));
}

std::size_t words_of(WireFormat wire) { return wire == WireFormat::farm ? kMagnetometerColumns : 1; }
std::size_t header_of(WireFormat wire) { return wire == WireFormat::farm ? kMagnetHeader : 0; }

/// A saturated word means "this or more".
bool plausible(std::span<const std::uint8_t> payload, WireFormat wire, std::size_t words, double limit) {
  base::ByteReader reader(payload.subspan(header_of(wire)));
  for (std::size_t i = 0; i < words; ++i) {
    const Word word = reader.get<Word>();
    if (word == kLeast || word == kMost) continue;
    if (std::abs(word * kUnit) > limit + kUnit) return false;
  }
  return true;
}

}  // namespace

std::string magnetometer_wire_problem(const SensorSpec&, WireFormat) { return ""; }

std::uint32_t magnetometer_parts(const SensorSpec&, WireFormat) { return 1; }

std::uint8_t encode_magnetometer(const SensorSpec& sensor, const base::ReadingBlock& reading, WireFormat wire,
                                 std::uint32_t part, base::Bytes& out) {
  const std::span<const double> values = reading.values;
  const std::size_t count = values.size() / kMagnetometerColumns;
  SF_CHECK(part == 0 && count >= 1 && count == sensor.elements && count <= kMostElements &&
               values.size() == count * kMagnetometerColumns,
           std::to_string(values.size()) + " values of " + std::to_string(sensor.elements) + " elements");
  if (std::any_of(values.begin(), values.end(), [](double tesla) { return std::isnan(tesla); })) return 0;
  base::ByteWriter writer(out);
  if (wire == WireFormat::farm) {
    writer.put(static_cast<std::uint16_t>(count));
    writer.put(std::uint16_t{0});
  }
  for (std::size_t e = 0; e < count; ++e)
    for (std::size_t k = 0; k < words_of(wire); ++k) writer.put(to_word(values[kMagnetometerColumns * e + k]));
  return kMagnetometer;
}

double magnetometer_wire_error(const SensorSpec&, const base::ReadingBlock& reading) {
  return wire_error(reading.values, kMagnetometerColumns, kUnit, kLeast * kUnit, kMost * kUnit);
}

PayloadPart decode_magnetometer(const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t type,
                                WireFormat wire) {
  if (type != kMagnetometer) return {.fault = PayloadError::out_of_range};
  base::ByteReader reader(payload);
  const std::size_t element = kMagnetWord * words_of(wire);
  const std::size_t body = payload.size() - std::min(payload.size(), header_of(wire));
  const std::size_t said =
      wire == WireFormat::farm ? reader.get<std::uint16_t>() : std::max<std::size_t>(1, body / element);
  if (payload.size() < header_of(wire) || body < said * element) return {.fault = PayloadError::too_short};
  if (body > said * element) return {.fault = PayloadError::too_long};
  if (said < 1 || said > kMostElements) return {.fault = PayloadError::out_of_range};
  const bool whole = sensor.elements == 0 || said == sensor.elements;
  const bool likely = sensor.limit <= 0.0 || plausible(payload, wire, said * words_of(wire), sensor.limit);
  if (!whole || !likely) return {.fault = PayloadError::out_of_range};
  return {.elements = static_cast<std::uint32_t>(said)};
}

void read_magnetometer_payload(const SensorSpec&, std::span<const std::uint8_t> payload, std::uint8_t, WireFormat wire,
                               std::span<double> values) {
  base::ByteReader reader(payload.subspan(header_of(wire)));
  const std::size_t words = words_of(wire);
  SF_CHECK(reader.left() / (kMagnetWord * words) * kMagnetometerColumns == values.size(),
           std::to_string(payload.size()) + " bytes for " + std::to_string(values.size()) + " values");
  for (std::size_t e = 0; e < values.size() / kMagnetometerColumns; ++e)
    for (std::size_t k = 0; k < words; ++k) values[kMagnetometerColumns * e + k] = reader.get<Word>() * kUnit;
}

}  // namespace sf::sensors
