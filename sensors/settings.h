#pragma once
// A sensor's settings in a world file, read by its kind: in metres, radians and seconds, or refused with file and line.

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sensors/sensor_type.h"

namespace sf::sensors {

/// @throws base::InputError, always, at the setting `key`, or at the sensor where it has no such setting.
[[noreturn]] void refuse(const world::Sensor& sensor, std::string_view key, const std::string& message);

/// The setting of that exact key, or null. Lives as long as the sensor.
const world::Setting* find(const world::Sensor& sensor, std::string_view key);

// Each reads one setting, or gives the fallback where there is none.
// @throws base::InputError when it is of another kind or outside [least, most].

double number(const world::Sensor& sensor, std::string_view key, double fallback, double least, double most);
/// [m]; bounds and fallback too.
double length(const world::Sensor& sensor, std::string_view key, double fallback, double least, double most);
/// [rad]; bounds and fallback too.
double angle(const world::Sensor& sensor, std::string_view key, double fallback, double least, double most);
std::uint32_t whole(const world::Sensor& sensor, std::string_view key, std::uint32_t fallback, std::uint32_t least,
                    std::uint32_t most);
/// One of `words`. @return its place among them.
std::size_t choice(const world::Sensor& sensor, std::string_view key, std::size_t fallback,
                   std::span<const std::string_view> words);
/// The numbers of a tuple as written, at least `least` of them. @param meaning e.g. "[min max]", for the error.
std::optional<std::vector<double>> tuple(const world::Sensor& sensor, std::string_view key, std::size_t least,
                                         const std::string& meaning);

/// [Hz] of `rate` or `update_interval`.
double rate_of(const world::Sensor& sensor, double fallback);

/// Refuses numbered settings that are written but not counted: `zone[4]` where `zones` is 4.
/// @param prefix what their keys begin with  @param counter the key that counts them from 0, at most `most`
/// @throws base::InputError at the first of them in the file.
void refuse_beyond(const world::Sensor& sensor, std::string_view prefix, std::string_view counter, std::uint32_t count,
                   std::uint32_t most);

/// Name, rate (or update_interval), phase and latency, as every sensor has them; one element.
SensorSpec common_spec(const world::Sensor& sensor, std::uint32_t mover, std::uint32_t number_of_kind);

/// Calls `body` for every sensor called `type`, by mover and in file order. @param number 0-based among the mover's
void for_each_of(
    const world::World& world, std::string_view type,
    const std::function<void(const world::Sensor& sensor, std::uint32_t mover, std::uint32_t number)>& body);

}  // namespace sf::sensors
