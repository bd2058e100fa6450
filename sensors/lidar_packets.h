#pragma once
// Scans of lidars as payloads; docs/packets.md specifies every byte. Lidars that report only ranges use the forms of
// lasers. The others use the extended form with all numbers of a beam in turn. The first six functions are the wire
// part of the lidar's SensorType.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/bytes.h"
#include "base/reading.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr double kIntensityStep = 1e-3;  ///< of a payload's intensities, which saturate at 65.535
inline constexpr double kIncidenceStep = 1e-4;  ///< [rad]

std::string lidar_wire_problem(const SensorSpec& sensor, WireFormat wire);
std::uint32_t lidar_parts(const SensorSpec& sensor, WireFormat wire);
std::uint8_t encode_lidar(const SensorSpec& sensor, const base::ReadingBlock& scan, WireFormat wire, std::uint32_t part,
                          base::Bytes& out);
/// As laser_wire_error, of the first ranges.
double lidar_wire_error(const SensorSpec& sensor, const base::ReadingBlock& scan);
PayloadPart decode_lidar(const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t type,
                         WireFormat wire);
void fill_lidar(const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t type, WireFormat wire,
                std::span<double> values);

/// A decoded payload: a whole scan, or one part of it.
struct LidarPart {
  std::uint32_t total = 0;  ///< beams of the whole scan
  std::uint32_t first = 0;  ///< index of this part's first beam
  std::uint32_t count = 0;  ///< beams in this part
  std::uint16_t part = 0, parts = 1;
  std::uint32_t width = 1;     ///< numbers per beam
  std::vector<double> values;  ///< beam by beam; ranges are infinite without an echo, intensities saturated
};

/// Accepts any bytes. @param extended the type is the extended one
PayloadError read_lidar(std::span<const std::uint8_t> payload, bool extended, LidarPart& part);

}  // namespace sf::sensors
