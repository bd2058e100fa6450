#pragma once
// Readings as payloads for kinds whose rows are a few plain numbers: one form, little-endian; docs/packets.md gives
// every byte.
//
//   u16 count, u16 0, then for each row i32 for each of the kind's numbers
//
// Each number is counted in its own unit, rounded to nearest (half away from zero); words saturate and never wrap. The
// least word says that there is no number. The thesis has no layout for such kinds.

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "base/bytes.h"
#include "base/reading.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::int32_t kNoNumber = std::numeric_limits<std::int32_t>::min();  ///< on the wire: not a number
inline constexpr std::uint32_t kMaxPlainWords =
    313;  ///< numbers in one datagram of 1400 bytes, header and signature and all

/// One number of a row on the wire.
struct PlainNumber {
  double unit = 1.0;  ///< > 0, of the column's own unit
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();  ///< in the column's own unit: beyond is no such reading
};

/// How one kind is sent.
struct PlainForm {
  std::uint8_t id = 0;                   ///< wire id, and the type of its packets
  std::string_view name;                 ///< of the kind, for messages
  std::span<const PlainNumber> numbers;  ///< of one row: as many as its columns have; alive for good
};

// What SensorKind asks of a kind, for `form`. Rows have at most kMaxPlainWords numbers in all: one datagram.

/// The thesis' wire is refused.
std::string plain_wire_problem(const PlainForm& form, WireFormat wire);
std::uint8_t encode_plain(const PlainForm& form, const SensorSpec& sensor, const base::ReadingBlock& reading,
                          base::Bytes& out);
/// Any bytes are judged. A row of no elements leaves their number unchecked.
PayloadPart decode_plain(const PlainForm& form, const SensorSpec& sensor, std::span<const std::uint8_t> payload,
                         std::uint8_t type, WireFormat wire);
void read_plain(const PlainForm& form, std::span<const std::uint8_t> payload, std::span<double> values);

/// `kind`, sent in the form kForm, whose id and name it has.
template <const PlainForm& kForm>
consteval SensorType plain(SensorType kind) {
  kind.id = kForm.id;
  kind.name = kForm.name;
  kind.wire_problem = [](const SensorSpec&, WireFormat wire) { return plain_wire_problem(kForm, wire); };
  kind.parts = [](const SensorSpec&, WireFormat) -> std::uint32_t { return 1; };
  kind.encode = [](const SensorSpec& sensor, const base::ReadingBlock& reading, WireFormat, std::uint32_t,
                   base::Bytes& out) { return encode_plain(kForm, sensor, reading, out); };
  kind.decode = [](const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t type,
                   WireFormat wire) { return decode_plain(kForm, sensor, payload, type, wire); };
  kind.read = [](const SensorSpec&, std::span<const std::uint8_t> payload, std::uint8_t, WireFormat,
                 std::span<double> values) { read_plain(kForm, payload, values); };
  return kind;
}

}  // namespace sf::sensors
