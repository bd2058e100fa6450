#pragma once
// Which sensors of a world are sent, and at which ports: one layout for senders and receivers.

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "netio/ports.h"
#include "sensors/sensor_set.h"
#include "world/world.h"

namespace sf::server {

struct LayoutOptions {
  std::map<std::uint8_t, std::uint32_t> base_ports;  ///< by sensor type; contains every type of the world
  std::uint32_t ports_per_robot = 0;                 ///< 0: 8, or the minimum that fits
  sensors::WireFormat wire = sensors::WireFormat::farm;
};

struct StreamLayout {
  std::map<std::uint8_t, std::uint32_t> bases;  ///< by sensor type
  std::uint32_t stride = 8;                     ///< ports per robot
  sensors::WireFormat wire = sensors::WireFormat::farm;
  std::vector<std::string> notes;  ///< for the user: sensors left out, and a stride other than 8

  netio::PortRule ports(const sensors::SensorType& type) const { return {bases.at(type.id), stride}; }
  /// Returns false for sensors without a layout in the thesis' wire format: they are neither sent nor expected.
  bool sends(const sensors::SensorType& type, const sensors::SensorSpec& sensor) const {
    return type.wire_problem(sensor, wire).empty();
  }
  bool sends_any(const sensors::SensorSet::Group& group) const;
};

/// Depends only on world and options, so that `serve`, `robot`, `run` and `listen` agree. The stride is the user's,
/// else 8, else the minimum that keeps all ports apart.
/// @throws base::InputError if two sensors would share a port, a port exceeds 65535, or the wire format carries no
/// sensor
StreamLayout stream_layout(const world::World& world, const sensors::SensorSet& sensor_set,
                           const LayoutOptions& options);

}  // namespace sf::server
