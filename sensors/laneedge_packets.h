#pragma once
// Lane edge readings as little-endian payloads; docs/packets.md specifies every byte. Readings are in metres, payloads
// in integer wire units, rounded to nearest. Values saturate and never wrap.
//
//   farm    u16 distance [mm] in [0, 65534], 65535 no edge in sight; u16 points; u32 residual [um]; u32 sigma [um]
//   thesis  u16 distance [mm], 65535 no edge in sight

#include <cstdint>
#include <span>
#include <string>

#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint16_t kNoEdge = 65'535;  ///< on the wire: no edge in sight

std::string lane_edge_wire_problem(const SensorSpec& sensor, WireFormat wire);  ///< always empty
std::uint32_t lane_edge_parts(const SensorSpec& sensor, WireFormat wire);       ///< always 1
/// @return the payload's type. A reading without an edge is also sent.
std::uint8_t encode_lane_edge(const SensorSpec& sensor, const base::ReadingBlock& reading, WireFormat wire,
                              std::uint32_t part, base::Bytes& out);
/// Implements SensorType::wire_error: half a millimetre; infinite for a distance that is sent as 0 or 65534 but is less
/// or more.
double lane_edge_wire_error(const SensorSpec& sensor, const base::ReadingBlock& reading);
PayloadPart decode_lane_edge(const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t type,
                             WireFormat wire);
/// Fills in the four columns from a payload that `decode_lane_edge` accepted. The thesis format has only the first.
/// Reserved wire values become NaN.
void read_lane_edge(const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t type, WireFormat wire,
                    std::span<double> values);

}  // namespace sf::sensors
