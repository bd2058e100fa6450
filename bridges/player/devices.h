#pragma once
// The devices of a run that clients of Player see: position2d and sensors of each robot, and one simulation and one map
// for all.

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/bytes.h"
#include "base/reading.h"
#include "bridges/player/geometry.h"
#include "netio/player/protocol.h"
#include "sensors/sensor_set.h"
#include "world/world.h"

namespace sf::bridges::player {

/// Maximum number of elements of a sensor that fit a message; devices of larger sensors are not offered.
inline constexpr std::uint32_t kMostElements = 1'000'000;

struct Device {
  Interface interf = Interface::simulation;
  std::string name;                    ///< shown as the driver's name: the robot's, with ".sensor"
  std::uint32_t mover = world::kNone;  ///< row; kNone: simulation, map
  const sensors::SensorSpec* sensor = nullptr;
  std::uint8_t type = 0;              ///< of the sensor
  std::uint32_t slot = world::kNone;  ///< of the sensor's readings; kNone: none
  base::Bytes geometry;               ///< payload of the answer to GET_GEOM; empty: none
  base::Bytes config;                 ///< payload of the answer to GET_CONFIG; empty: none
};

/// Immutable. The world and the sensor set must outlive it.
class Devices {
 public:
  Devices(const world::World& world, const sensors::SensorSet& sensor_set);

  std::span<const Device> rows() const { return rows_; }
  /// Returns rows of movers with devices: robots, and tags with sensors.
  std::span<const std::uint32_t> robots() const { return robots_; }
  /// Returns the number of slots for readings, one per sensor of the world.
  std::size_t slots() const { return slots_; }
  std::uint32_t slot_of(std::uint8_t type, std::uint32_t mover, std::uint32_t sensor) const;

 private:
  void add_robot(std::uint32_t mover, const SensorGeometry& geometry);

  const world::World& world_;
  const sensors::SensorSet& sensor_set_;
  std::vector<Device> rows_;
  std::vector<std::uint32_t> robots_;
  std::map<std::uint8_t, std::uint32_t> first_slot_;  ///< by sensor type
  std::size_t slots_ = 0;
};

/// The devices at one port, numbered from 0 per interface in the order of the world file.
class Listing {
 public:
  /// @param mover the only robot at the port; nullopt: all robots
  Listing(const Devices& devices, std::optional<std::uint32_t> mover);

  /// Returns rows of `Devices` by address.
  const std::map<Address, std::uint32_t>& rows() const { return rows_; }

 private:
  std::map<Address, std::uint32_t> rows_;
};

}  // namespace sf::bridges::player
