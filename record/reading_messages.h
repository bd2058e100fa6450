#pragma once
// Readings of all types except scans as messages of their own types, derived from the sensor type's columns:
// `sensorfarm_msgs/msg/Magnetometer` and so on.
//
// A message type has a header and one field per column: float64, float64[width], or uint32 for whole numbers. For a
// sensor type with a list, it has one array with the numbers of all elements. ROS field names are in lower case:
// `vector_T` becomes `vector_t`.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/bytes.h"
#include "record/run_info.h"

namespace sf::record {

/// Returns "sensorfarm_msgs/msg/Magnetometer"; for scans "sensor_msgs/msg/LaserScan".
std::string type_of(const SensorTypeInfo& sensor_type);
/// Returns its definition, with all types that it needs, for a file's schema.
std::string schema_text(const SensorTypeInfo& sensor_type);

/// Returns the number of values in one element of a reading; at least 1 in a valid sensor type.
std::size_t element_width(const SensorTypeInfo& sensor_type);

/// Appends one message. @pre `values` are whole elements, and exactly one element for a sensor type without a list
/// @param time [ns] of the measurement
/// @param width numbers per element, those of the first columns, if the type has a list: the arrays of the others are
///              empty; 0: all
void encode_reading(const SensorTypeInfo& sensor_type, std::int64_t time, std::string_view frame,
                    std::span<const double> values, base::Bytes& out, std::size_t width = 0);

/// @param values element by element, as in the reading; its capacity is reused
/// @param width out, unless null: numbers per element
/// @return false if the bytes are not a reading of that type; the outputs are then partly filled
bool decode_reading(const SensorTypeInfo& sensor_type, std::span<const std::uint8_t> message, std::int64_t& time,
                    std::vector<double>& values, std::size_t* width = nullptr);

}  // namespace sf::record
