#pragma once
// Readings of magnetometer arrays as little-endian payloads; docs/packets.md specifies every byte. Readings are in
// tesla, payloads in 1e-4 Gauss (1e-8 T), rounded to nearest (half away from zero). Words saturate and never wrap.
//
//   farm:   u16 count, u16 0, then for each element i32 field, x, y, z
//   thesis: for each element i32 field; the count follows from the payload's length
//
// The functions read only `elements` and `limit` of a spec.

#include <cstdint>
#include <span>
#include <string>

#include "base/bytes.h"
#include "base/reading.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

/// Returns an empty text: every array fits both formats.
std::string magnetometer_wire_problem(const SensorSpec& sensor, WireFormat wire);

/// Returns 1.
std::uint32_t magnetometer_parts(const SensorSpec& sensor, WireFormat wire);

/// Appends the payload of a reading. @return its type; 0, with nothing appended, when a value is NaN
std::uint8_t encode_magnetometer(const SensorSpec& sensor, const base::ReadingBlock& reading, WireFormat wire,
                                 std::uint32_t part, base::Bytes& out);

/// Implements SensorType::wire_error for the elements' fields: half of 1e-8 T.
double magnetometer_wire_error(const SensorSpec& sensor, const base::ReadingBlock& reading);

/// Validates a payload against this array: equal number of elements, none beyond its limit by more than a unit. A spec
/// with 0 elements or limit 0 disables the respective check.
PayloadPart decode_magnetometer(const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t type,
                                WireFormat wire);

/// Fills in all columns from a payload that `decode_magnetometer` accepted. The thesis format has only each element's
/// field.
void read_magnetometer_payload(const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t type,
                               WireFormat wire, std::span<double> values);

}  // namespace sf::sensors
