#pragma once
// Readings of a few plain numbers as payloads, in a single little-endian layout; docs/packets.md specifies every byte.
//
//   u16 count, u16 0, then for each row i32 (or f32) for each of the sensor's numbers
//
// Each number has its own unit and is rounded to nearest (half away from zero). Words saturate and never wrap. The
// smallest word means NaN. The thesis format has no layout for these types.

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "base/bytes.h"
#include "base/reading.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::int32_t kNoNumber = std::numeric_limits<std::int32_t>::min();  ///< on the wire: NaN
inline constexpr std::uint32_t kMaxPlainWords =
    313;  ///< numbers in one datagram of 1400 bytes, including header and signature

/// One number of a row on the wire.
struct PlainNumber {
  double unit = 1.0;  ///< > 0, in units of the column
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();  ///< in units of the column; values beyond are invalid
  bool range =
      false;  ///< number of a range sensor: a word at or beyond that of a limit is read as the limit (WireLimits)
  bool real = false;  ///< on the wire an IEEE 754 f32 instead of a multiple of `unit`
};

/// Wire form of one sensor type.
struct PlainForm {
  std::uint8_t id = 0;                   ///< wire id and packet type
  std::string_view name;                 ///< of the sensor type, for messages
  std::span<const PlainNumber> numbers;  ///< of one row: one per column number; static lifetime
  std::uint32_t fewest =
      0;  ///< sensors may have this many numbers per row or more (SensorSpec::width); 0: all have all
};

// Wire part of SensorType for `form`. Rows have at most kMaxPlainWords numbers in total: one datagram.

/// Rejects the thesis format.
std::string plain_wire_problem(const PlainForm& form, WireFormat wire);
/// Also rejects readings that do not fit into one datagram.
std::string plain_wire_problem(const PlainForm& form, const SensorSpec& sensor, WireFormat wire);
std::uint8_t encode_plain(const PlainForm& form, const SensorSpec& sensor, const base::ReadingBlock& reading,
                          base::Bytes& out);
/// Accepts any bytes. A spec with 0 elements disables the check of their number.
PayloadPart decode_plain(const PlainForm& form, const SensorSpec& sensor, std::span<const std::uint8_t> payload,
                         std::uint8_t type, WireFormat wire);
void read_plain(const PlainForm& form, const SensorSpec& sensor, std::span<const std::uint8_t> payload,
                std::span<double> values);

/// Returns `type` with the id, name and wire part of kForm.
template <const PlainForm& kForm>
consteval SensorType plain(SensorType sensor_type) {
  sensor_type.id = kForm.id;
  sensor_type.name = kForm.name;
  sensor_type.wire_problem = [](const SensorSpec&, WireFormat wire) { return plain_wire_problem(kForm, wire); };
  sensor_type.parts = [](const SensorSpec&, WireFormat) -> std::uint32_t { return 1; };
  sensor_type.encode = [](const SensorSpec& sensor, const base::ReadingBlock& reading, WireFormat, std::uint32_t,
                          base::Bytes& out) { return encode_plain(kForm, sensor, reading, out); };
  sensor_type.decode = [](const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t type,
                          WireFormat wire) { return decode_plain(kForm, sensor, payload, type, wire); };
  sensor_type.read = [](const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t, WireFormat,
                        std::span<double> values) { read_plain(kForm, sensor, payload, values); };
  return sensor_type;
}

}  // namespace sf::sensors
