#pragma once
// Occupancy maps as payloads: implements the wire part of a SensorType with maps/map_packets.h. The functions read only
// `elements` (words), `across` (words in a row) and `pitch` (side of a cell) of a spec.

#include <cstdint>
#include <span>
#include <string>

#include "sensors/sensor_type.h"

namespace sf::sensors {

/// Returns a problem for maps that the thesis format cannot hold: more than 1 022 words in total, or more than 255 rows
/// or columns of words.
std::string occupancy_wire_problem(const SensorSpec& sensor, WireFormat wire);

std::uint32_t occupancy_parts(const SensorSpec& sensor, WireFormat wire);

/// @param reading its X_WS is the map's upper left corner  @return kOccupancy
std::uint8_t encode_occupancy(const SensorSpec& sensor, const base::ReadingBlock& reading, WireFormat wire,
                              std::uint32_t part, base::Bytes& out);

/// Validates a payload against this sensor: equal size and cells, any position. A spec with 0 elements disables the
/// check.
PayloadPart decode_occupancy(const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t type,
                             WireFormat wire);

void read_occupancy(const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t type, WireFormat wire,
                    std::span<double> values);

}  // namespace sf::sensors
