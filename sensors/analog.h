#pragma once
// Analogue inputs of a robot's controller, as those of the Khepera's and the Pioneer's ports (docs/sensors.md).
//
// In a world file, inside a robot:
//   analog( inputs 2  input[0] ["constant" 2.5]  input[1] ["light" 0.004]  spose[1] [x y yaw]  range [0 5]  bits 10 )
// A reading has one row per input: its voltage within the range, and the converter's number, 0 to 2^bits - 1.

#include <cstdint>
#include <vector>

#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kAnalog = 30;             ///< wire id
inline constexpr std::uint32_t kMostAnalogInputs = 16;  ///< per sensor
inline constexpr std::uint32_t kMostAnalogBits = 16;

/// One input, and the circuit at it.
struct AnalogInput {
  enum class Source : std::uint8_t { constant, light };
  Source source = Source::constant;
  double gain = 0.0;  ///< constant: [V]; light: [V/lx], of a photo sensor that looks along the x of X_SE
  Pose X_SE;          ///< in the sensor frame
};

/// Settings of one sensor.
struct Analog {
  std::vector<AnalogInput> inputs;
  double least = 0.0;       ///< [V]
  double most = 5.0;        ///< [V] > least
  std::uint32_t bits = 10;  ///< of the converter, in [1, 16]
};

/// @throws base::InputError with file and line.
Analog read_analog(const world::Sensor& sensor);

extern const SensorType analog_type;

}  // namespace sf::sensors
