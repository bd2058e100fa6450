#pragma once
// Reads settings of a sensor in a world file, in metres, radians and seconds. Invalid settings throw errors with file
// and line.

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sensors/sensor_type.h"

namespace sf::sensors {

/// Always throws. @throws base::InputError at the setting `key`, or at the sensor if the setting is absent
[[noreturn]] void refuse(const world::Sensor& sensor, std::string_view key, const std::string& message);

/// Returns the setting with that exact key, or null. Valid as long as the sensor.
const world::Setting* find(const world::Sensor& sensor, std::string_view key);

// Each function reads one setting, or returns the fallback if it is absent.
// @throws base::InputError when it has another type or is outside [least, most]

double number(const world::Sensor& sensor, std::string_view key, double fallback, double least, double most);
/// Reads a length [m], including bounds and fallback.
double length(const world::Sensor& sensor, std::string_view key, double fallback, double least, double most);
/// Reads an angle [rad], including bounds and fallback.
double angle(const world::Sensor& sensor, std::string_view key, double fallback, double least, double most);
/// Returns a hint for the error of an angle [rad] beyond its bounds: that the file's angles are in radians, if they
/// are. Otherwise empty.
std::string hint_of_radians(const world::Sensor& sensor, double angle);
std::uint32_t whole(const world::Sensor& sensor, std::string_view key, std::uint32_t fallback, std::uint32_t least,
                    std::uint32_t most);
/// Reads one of `words`. @return its index
std::size_t choice(const world::Sensor& sensor, std::string_view key, std::size_t fallback,
                   std::span<const std::string_view> words);
/// Reads the numbers of a tuple as written, at least `least` of them. @param meaning such as "[min max]", for the error
std::optional<std::vector<double>> tuple(const world::Sensor& sensor, std::string_view key, std::size_t least,
                                         const std::string& meaning);

/// Returns the index of the name that `preset` states; nullopt without that setting.
std::optional<std::size_t> preset_of(const world::Sensor& sensor, std::span<const std::string_view> names);
/// Returns the one of `presets`, by its `name`, that `preset` states; null without that setting.
template <class Preset, std::size_t count>
const Preset* preset_of(const world::Sensor& sensor, const Preset (&presets)[count]) {
  std::vector<std::string_view> names;
  for (const Preset& preset : presets) names.push_back(preset.name);
  const auto row = preset_of(sensor, std::span<const std::string_view>(names));
  return row ? &presets[*row] : nullptr;
}

/// Refuses limits of ranges unless 0 <= min < max <= most [m]. @param what they are, with an article or in the plural
void require_range(const world::Sensor& sensor, std::string_view key, std::string_view what, double min, double max,
                   double most);

/// Returns the mount of a spatial sensor in the mover's frame: `pose`, then `pose6`, at half of its model's height.
base::RigidTransform spatial_mount(const world::Sensor& sensor);
/// Returns a mount without its roll and pitch.
Pose planar_mount(const base::RigidTransform& X_MS);

/// Reads `rate` or `update_interval` [Hz].
double rate_of(const world::Sensor& sensor, double fallback);

/// Rejects numbered settings beyond their count: `zone[4]` when `zones` is 4.
/// @param prefix start of their keys  @param counter key of the count, which is at most `most`
/// @throws base::InputError at the first of them in the file
void refuse_beyond(const world::Sensor& sensor, std::string_view prefix, std::string_view counter, std::uint32_t count,
                   std::uint32_t most);

/// Reads the common settings: name, rate (or update_interval), phase and latency; one element.
SensorSpec common_spec(const world::Sensor& sensor, std::uint32_t mover, std::uint32_t number_of_type);

/// Calls `body` for every sensor called `type`, by mover and in file order. @param number 0-based per mover
void for_each_of(
    const world::World& world, std::string_view type,
    const std::function<void(const world::Sensor& sensor, std::uint32_t mover, std::uint32_t number)>& body);

}  // namespace sf::sensors
