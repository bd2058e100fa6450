#pragma once
// The part of a sensor type that only derived types have: ports for inputs, and a factory.
//
// In a world file, inside a robot:
//   derived( type "localization"  inputs ["encoder" "gyro" "gps:0"]  rate 20 )
// An input is "[port=][robot/]type[:number]". Without a robot it is a sensor of the same robot; "*/type" is that sensor
// of every robot. Columns of a reading: the quantities, `valid`, the upper triangle of their covariance, then others.

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "sensorfarm/derived.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

/// A kind of input of a built-in type: sensorfarm::InputPort.
struct DerivedPort {
  std::string_view name;
  std::span<const std::string_view> columns;  ///< empty: any
  std::uint32_t least = 0;
  std::uint32_t most = 1;
};

/// One input of a derived sensor.
struct WiredInput {
  std::uint32_t port = 0;
  std::uint32_t mover = 0;
  std::uint8_t type = 0;  ///< wire id
  std::uint32_t sensor = 0;
  std::uint32_t place = 0;  ///< row of the text in `inputs` that names it
  auto operator<=>(const WiredInput&) const = default;
};

/// All that a derived sensor is created from.
struct DerivedContext {
  const world::World& world;
  const world::Sensor& settings;
  const SensorSpec& spec;
  std::span<const WiredInput> inputs;
  const sensorfarm::DerivedSite& site;
  /// Per input: SensorSpec::sigma of a sensor that measures, in the unit of its first column; 0: none, or not stated.
  std::span<const double> sigmas;
};

/// The part of a SensorType that derived types have.
struct DerivedForm {
  std::span<const DerivedPort> ports;
  std::uint32_t quantities = 1;  ///< columns of a row before `valid`
  bool covariance = false;
  std::uint32_t extra = 0;  ///< columns of a row after the covariance, also of a row that is not valid; in
                            ///< `DerivedReading::values` they follow the row's quantities
  /// @throws base::InputError for invalid settings
  std::unique_ptr<sensorfarm::DerivedSensor> (*make)(const DerivedContext& context) = nullptr;
};

/// Returns the number of values in the upper triangle of a covariance of `quantities` numbers.
constexpr std::uint32_t triangle(std::uint32_t quantities) { return quantities * (quantities + 1) / 2; }

/// Parses the derived sensors of `type`, each with `rows` rows.
ParsedSensors parse_derived(const world::World& world, const SensorType& type, std::uint32_t rows, double rate);

/// The same for a type whose setting `most` is the number of rows, in [1, `most`].
ParsedSensors parse_derived_rows(const world::World& world, const SensorType& type, std::uint32_t rows,
                                 std::uint32_t most, double rate);

/// Returns null: derived sensors are evaluated by DerivedSensors.
std::unique_ptr<SensorBackend> no_backend(const SensorContext& context, const ParsedSensors& sensors);

/// Keys of all derived sensors.
inline constexpr std::string_view kDerivedKeys[] = {"type", "inputs"};

}  // namespace sf::sensors
