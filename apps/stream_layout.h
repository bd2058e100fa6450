#pragma once
// Which sensors of a world are sent, and to which ports: one plan for those who send and those who receive.

#include <cstdint>
#include <map>

#include "apps/options.h"
#include "netio/ports.h"
#include "sensors/sensor_set.h"
#include "world/world.h"

namespace sf::apps {

struct StreamLayout {
  std::map<std::uint8_t, std::uint32_t> bases;  ///< by sensor kind
  std::uint32_t stride = 8;                     ///< ports per robot
  sensors::WireFormat wire = sensors::WireFormat::farm;

  netio::PortRule ports(const sensors::SensorType& kind) const { return {bases.at(kind.id), stride}; }
  /// The thesis' wire has no layout for some sensors: these are neither sent nor awaited.
  bool sends(const sensors::SensorType& kind, const sensors::SensorSpec& sensor) const {
    return kind.wire_problem(sensor, wire).empty();
  }
  bool sends_any(const sensors::SensorSet::Group& group) const;
};

/// A function of world and options alone, so that `serve`, `robot`, `run` and `listen` agree. The stride is the user's,
/// else 8, else the least that keeps all ports apart. Says on standard error what is left out, and another stride
/// than 8.
/// @throws base::InputError when two sensors would share a port, one is past 65535, or the wire carries no sensor.
StreamLayout stream_layout(const world::World& world, const sensors::SensorSet& sensor_set, const Options& options);

}  // namespace sf::apps
