#pragma once
// Aggregate: a named quantity from unlike sensors, or an expression of their numbers, as a derived sensor
// (docs/derived.md).
//
// In a world file, inside a robot:
//   derived( type "aggregate"  name "temperature"  inputs ["thermometer" "hall/thermometer"]
//            quantity "temperature_C"  choose "weighted" )
//   derived( type "aggregate"  name "fahrenheit"  inputs ["thermometer"]
//            expression "1.8 * thermometer.temperature_C + 32" )
// `quantity` is a column that all inputs have, of which the first row counts; with the properties of
// sensors/aggregation.h. An expression names the numbers of each input's first row "[robot.]type[number].column": the
// robot where it is another one, the number from 1 on. Of these properties only `max_age` and `noise` apply to it.
//
// A reading is one row: the value in the unit of the quantity, whether it is valid, its variance, the input that it is
// from (-1: several) and the age of the oldest reading in it. The variance of an expression is to first order, by
// differences of one standard deviation of each number, as if their errors were independent. It is NaN where an input
// states no error.

#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kAggregate = 43;  ///< wire id

extern const SensorType aggregate_type;

}  // namespace sf::sensors
