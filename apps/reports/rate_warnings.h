#pragma once
// How often sensors are read, and what is too slow for them.

#include <string>
#include <utility>
#include <vector>

#include "sensors/sensor_set.h"

namespace sf::apps {

/// [Hz] The least and the largest of one type.
std::pair<double, double> rates_of(const sensors::SensorSet::Group& group);
/// "laser 10 to 13 Hz", of one type.
std::string rate_text(const sensors::SensorSet::Group& group);

/// Names of the types that have sensors which are due between ticks of `interval` [s].
std::vector<std::string> types_between_ticks(const sensors::SensorSet& sensor_set, double interval);

/// Says on standard error which sensors ticks at `rate` [Hz] are too slow for, where they are read at ticks alone.
void warn_of_fast_sensors(const sensors::SensorSet& sensor_set, double rate);

/// Says on standard error when sensors are due at more than a thousand different times a second: each is a batch of its
/// own.
void warn_of_many_times(const sensors::SensorSet& sensor_set);

}  // namespace sf::apps
