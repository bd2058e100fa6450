#pragma once
// The sensors of a user-defined type in a world, measured on the host or by the type's kernel.

#include <cstdint>
#include <memory>
#include <vector>

#include "sensorfarm/sensor.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

/// A user-defined type: the user's entry, and its row among the sensor types.
struct OwnType {
  sensorfarm::SensorEntry entry;
  std::vector<std::uint32_t> spirv;  ///< of its kernel; empty: none
  std::vector<std::string_view> keys;
  std::vector<Column> columns;
  SensorType type;
};

/// A sensor with its spec.
struct OwnSensor {
  SensorSpec spec;
  std::unique_ptr<sensorfarm::Sensor> sensor;
};

/// Returns the world's sensors of that type, by mover and in file order.
/// @throws base::InputError with file and line for invalid settings, and when the user's function rejects a sensor
std::vector<OwnSensor> own_sensors(const world::World& world, const OwnType& type);

std::unique_ptr<SensorBackend> make_own_backend(const SensorContext& context, const OwnType& type);

}  // namespace sf::sensors
