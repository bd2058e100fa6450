#pragma once
// Sampling rates of sensors, and warnings about tick rates that are too low for them.

#include <string>
#include <utility>
#include <vector>

#include "sensors/sensor_set.h"

namespace sf::apps {

/// Returns the lowest and highest rate [Hz] of one type.
std::pair<double, double> rates_of(const sensors::SensorSet::Group& group);
/// Returns the rates of one type, such as "laser 10 to 13 Hz".
std::string rate_text(const sensors::SensorSet::Group& group);

/// Returns the names of the types with sensors that are due between ticks of `interval` [s].
std::vector<std::string> types_between_ticks(const sensors::SensorSet& sensor_set, double interval);

/// Warns on standard error about sensors whose rate exceeds the tick rate `rate` [Hz], if they are read only at ticks.
void warn_of_fast_sensors(const sensors::SensorSet& sensor_set, double rate);

/// Warns on standard error if sensors are due at more than a thousand different times per second, since each time is a
/// separate batch.
void warn_of_many_times(const sensors::SensorSet& sensor_set);

}  // namespace sf::apps
