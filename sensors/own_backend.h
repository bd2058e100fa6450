#pragma once
// The sensors of one own type in a world, measured on the host or by the type's kernel.

#include <cstdint>
#include <memory>
#include <vector>

#include "sensorfarm/sensor.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

/// An own type: what its user gave, and its row among the sensor types.
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

/// The world's sensors of that type, by mover and in file order.
/// @throws base::InputError with file and line for invalid settings, and where the user's function refuses one
std::vector<OwnSensor> own_sensors(const world::World& world, const OwnType& type);

std::unique_ptr<SensorBackend> make_own_backend(const SensorContext& context, const OwnType& type);

}  // namespace sf::sensors
