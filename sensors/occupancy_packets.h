#pragma once
// Occupancy maps as payloads: maps/map_packets.h as the wire part of a SensorKind. Of a row they read `elements`
// (words), `across` (words in a row) and `pitch` (side of a cell).

#include <cstdint>
#include <span>
#include <string>

#include "sensors/kind.h"

namespace sf::sensors {

/// The thesis' form holds at most 1 022 words, and 255 rows or columns of them.
std::string refuse_occupancy(const SensorRow& sensor, Wire wire);

std::uint32_t occupancy_parts(const SensorRow& sensor, Wire wire);

/// @param reading its X_WS is the map's upper left corner. @return kOccupancy
std::uint8_t encode_occupancy(const SensorRow& sensor, const base::ReadingBlock& reading, Wire wire, std::uint32_t part,
                              base::Bytes& out);

/// Takes a payload for what this sensor may have sent: a map of its size and of its cells, wherever it lies. A row of
/// no elements leaves that unchecked.
Part decode_occupancy(const SensorRow& sensor, std::span<const std::uint8_t> payload, std::uint8_t type, Wire wire);

void read_occupancy(const SensorRow& sensor, std::span<const std::uint8_t> payload, std::uint8_t type, Wire wire,
                    std::span<double> values);

}  // namespace sf::sensors
