#pragma once
// Chooses each sensor's accuracy mode. The modes themselves are tables of the sensor types: sensors/laser_modes.h,
// sensors/laneedge_settings.h, sensors/magnetometer_modes.h.
//
// A world file sets `accuracy "word"` for all sensors or inside one of them; the word on the command line overrides
// both. Several words, separated by spaces, apply to several sensor types: a sensor takes the first word that its type
// has, or `exact` if there is none. `laser:skip2` applies to that type only.

#include <string>
#include <string_view>
#include <vector>

#include "sensors/sensor_set.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

/// Returns the row in `modes`, the modes of the sensor type `type`, for one sensor.
/// @param own the sensor's own setting in the world file
/// @throws base::InputError at that setting for an unknown word
std::uint8_t mode_of(std::string_view type, std::span<const AccuracyMode> modes, const world::Accuracy& own,
                     const world::World& world);

/// Returns the `accuracy "word"` setting of a sensor.
world::Accuracy accuracy_of(const world::Sensor& sensor);

/// @throws base::InputError when no sensor type, or none of the types `present`, has the world's word, or when a sensor
/// without modes sets one
void check_accuracy(const world::World& world, std::span<const SensorType* const> present);

/// Sets the world's words and clears the settings of its sensors.
void set_accuracy(world::World& world, const std::string& words);

/// Returns all words of all sensor types: `exact` first, then in order of the types.
std::vector<std::string_view> accuracy_words();

/// The bounds that a world's sensors state before a run: one row per type, mode and bound.
struct AccuracyStatement {
  const SensorType* type = nullptr;
  std::uint8_t mode = 0;
  std::uint32_t sensors = 0;  ///< number of sensors with this bound and noise
  ErrorBound bound;           ///< without noise
  double sigma = 0.0;         ///< SensorSpec::sigma
  /// Returns base::ReadingBlock::bound [unit of the first column]; infinite for a noisy sensor.
  double error() const { return sigma > 0.0 ? HUGE_VAL : bound.error; }
};
std::vector<AccuracyStatement> accuracy_statements(const world::World& world, const SensorSet& sensor_set);

/// Returns the modes in use other than exact, each once, such as "laser:single magnetometer:near3"; "exact" if there
/// are none.
std::string modes_of(const SensorSet& sensor_set);

/// Returns the unit of a type's first column, "m" or "T", from the suffix of its name; otherwise "".
std::string_view unit_of(const SensorType& type);

/// Returns the word of a mode; `exact` for types without modes.
std::string_view word_of(const SensorType& type, std::uint8_t mode);

}  // namespace sf::sensors
