#pragma once
// Choice of each sensor's accuracy mode. The modes themselves are tables of the sensor types: sensors/laser_modes.cpp,
// sensors/magnetometer_modes.cpp.
//
// A world file says `accuracy "word"` for all sensors, or inside one of them; the command line's word comes before
// both. Several words, with spaces between, are for several kinds: a sensor takes the first that its kind knows, and is
// exact when there is none. `laser:skip2` is for that kind alone.

#include <string>
#include <string_view>
#include <vector>

#include "sensors/sensor_set.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

/// Row of `modes`, those of the kind called `kind`, that a sensor measures in.
/// @param own what its place in the world file says  @throws base::InputError, there, for a word that is not among them
std::uint8_t mode_of(std::string_view kind, std::span<const AccuracyMode> modes, const world::Accuracy& own,
                     const world::World& world);

/// `accuracy "word"` among a sensor's settings.
world::Accuracy accuracy_of(const world::Sensor& sensor);

/// @throws base::InputError when no kind knows the world's word, or none that the world has sensors of; and where a
/// sensor of a kind without modes asks for one.
void check_accuracy(const world::World& world, std::span<const SensorType* const> present);

/// Makes `words` the world's, and takes back what its sensors say of their own.
void set_accuracy(world::World& world, const std::string& words);

/// Every word that some kind knows, `exact` first, in order of the kinds.
std::vector<std::string_view> accuracy_words();

/// What a world's sensors state before they measure: one row a kind, mode and bound.
struct AccuracyStatement {
  const SensorType* kind = nullptr;
  std::uint8_t mode = 0;
  std::uint32_t sensors = 0;  ///< of which this is true
  ErrorBound bound;
};
std::vector<AccuracyStatement> accuracy_statements(const world::World& world, const SensorSet& sensor_set);

/// "laser:single magnetometer:near3": the modes that are not exact, each once; "exact" where there are none.
std::string modes_of(const SensorSet& sensor_set);

/// "m" or "T" of a kind's first column, as its name says; else "".
std::string_view unit_of(const SensorType& kind);

/// The word of a mode: `exact` for kinds without modes.
std::string_view word_of(const SensorType& kind, std::uint8_t mode);

}  // namespace sf::sensors
