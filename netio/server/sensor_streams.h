#pragma once
// What a reading's payload says, judged by its sensor's kind: for those who receive.

#include <cstdint>
#include <span>
#include <vector>

#include "netio/server/stream_layout.h"
#include "netio/stream_monitor.h"
#include "sensors/sensor_set.h"

namespace sf::server {

/// The sensor behind one port.
struct SensorStream {
  const sensors::SensorType* kind = nullptr;
  const sensors::SensorSpec* row = nullptr;
};

/// All sensors of a world that are sent, kind after kind. They live as long as the roster.
std::vector<SensorStream> sensor_streams(const sensors::SensorSet& sensor_set, const StreamLayout& plan);
/// One mover's.
std::vector<SensorStream> sensor_streams(const sensors::SensorSet& sensor_set, const StreamLayout& plan,
                                         std::uint32_t mover);

/// Judges any bytes that came to the sensor's port behind a header of its robot and number.
netio::PayloadInfo inspect_payload(const SensorStream& source, sensors::WireFormat wire, const netio::Header& header,
                                   std::span<const std::uint8_t> payload);

/// Writes what an accepted payload says into its reading's values.
void decode_payload(const SensorStream& source, sensors::WireFormat wire, const netio::Header& header,
                    std::span<const std::uint8_t> payload, std::span<double> values);

}  // namespace sf::server
