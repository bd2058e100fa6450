#pragma once
// Received payloads: inspection and decoding by the tables of the sensor types.

#include <cstdint>
#include <span>
#include <vector>

#include "netio/stream_monitor.h"
#include "sensors/sensor_set.h"
#include "server/stream_layout.h"

namespace sf::server {

/// The sensor behind one port.
struct SensorStream {
  const sensors::SensorType* type = nullptr;
  const sensors::SensorSpec* row = nullptr;
};

/// Returns all sensors of a world with ports in the layout, ordered by sensor type. Pointers live as long as the sensor
/// set.
std::vector<SensorStream> sensor_streams(const sensors::SensorSet& sensor_set, const StreamLayout& layout);
/// Returns those of one mover.
std::vector<SensorStream> sensor_streams(const sensors::SensorSet& sensor_set, const StreamLayout& layout,
                                         std::uint32_t mover);

/// Checks the bytes of a payload, which may be arbitrary. Its header has the stream's robot and sensor number.
netio::PayloadInfo inspect_payload(const SensorStream& source, sensors::WireFormat wire, const netio::Header& header,
                                   std::span<const std::uint8_t> payload);

/// Decodes an accepted payload into the values of its reading.
void decode_payload(const SensorStream& source, sensors::WireFormat wire, const netio::Header& header,
                    std::span<const std::uint8_t> payload, std::span<double> values);

}  // namespace sf::server
