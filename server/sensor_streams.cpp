#include "server/sensor_streams.h"

#include "maps/map_packets.h"
#include "sensors/laser_packets.h"
#include "sensors/plain_packets.h"

namespace sf::server {

namespace {

// Sensor types do not depend on packets; check their longest payloads here.
static_assert(sensors::kPartBytes <= netio::kMaxPayload);
static_assert(sizeof(std::int32_t) * sensors::kMaxPlainWords < netio::kMaxPayload);
static_assert(sizeof(std::uint32_t) * maps::kPartWords < netio::kMaxPayload);

netio::PacketStatus reason_of(sensors::PayloadError fault) {
  switch (fault) {
    case sensors::PayloadError::none:
      return netio::PacketStatus::accepted;
    case sensors::PayloadError::too_short:
      return netio::PacketStatus::too_short;
    case sensors::PayloadError::too_long:
      return netio::PacketStatus::too_long;
    case sensors::PayloadError::out_of_range:
      break;
  }
  return netio::PacketStatus::out_of_range;
}

/// The thesis' datagrams carry no type: the port determines it.
std::uint8_t type_of(const SensorStream& source, sensors::WireFormat wire, const netio::Header& header) {
  return wire == sensors::WireFormat::farm ? static_cast<std::uint8_t>(header.type) : source.type->id;
}

}  // namespace

std::vector<SensorStream> sensor_streams(const sensors::SensorSet& sensor_set, const StreamLayout& layout) {
  std::vector<SensorStream> sources;
  for (const sensors::SensorSet::Group& group : sensor_set.groups())
    for (const sensors::SensorSpec& row : group.rows)
      if (layout.sends(*group.type, row)) sources.push_back({group.type, &row});
  return sources;
}

std::vector<SensorStream> sensor_streams(const sensors::SensorSet& sensor_set, const StreamLayout& layout,
                                         std::uint32_t mover) {
  std::vector<SensorStream> sources;
  for (const sensors::SensorSet::Group& group : sensor_set.groups())
    for (const sensors::SensorSpec& row : sensor_set.of(group.type->id, mover))
      if (layout.sends(*group.type, row)) sources.push_back({group.type, &row});
  return sources;
}

netio::PayloadInfo inspect_payload(const SensorStream& source, sensors::WireFormat wire, const netio::Header& header,
                                   std::span<const std::uint8_t> payload) {
  if (wire == sensors::WireFormat::farm && netio::sensor_type_of(header.type) != source.type->id)
    return {netio::PacketStatus::wrong_source};
  const sensors::PayloadPart part = source.type->decode(*source.row, payload, type_of(source, wire, header), wire);
  return {reason_of(part.fault), part.elements, part.part, part.parts};
}

void decode_payload(const SensorStream& source, sensors::WireFormat wire, const netio::Header& header,
                    std::span<const std::uint8_t> payload, std::span<double> values) {
  source.type->read(*source.row, payload, type_of(source, wire, header), wire, values);
}

}  // namespace sf::server
