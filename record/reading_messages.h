#pragma once
// Readings of any kind but laser as messages of their own types: `sensorfarm_msgs/msg/Magnetometer` and so on, made
// from the kind's columns.
//
// A type has a header and one field per column: float64, float64[width], or uint32 for whole numbers; where the kind
// has a list, one array of all elements' numbers. ROS writes field names in lower case: `vector_T` is `vector_t`.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/bytes.h"
#include "record/run_info.h"

namespace sf::record {

/// "sensorfarm_msgs/msg/Magnetometer".
std::string type_of(const SensorTypeInfo& kind);
/// Its definition, with every type it needs, for a file's schema.
std::string schema_text(const SensorTypeInfo& kind);

/// Numbers in one element of a reading; at least 1 in a kind that can be read.
std::size_t element_width(const SensorTypeInfo& kind);

/// Appends one message. Rule: `values` are whole elements, and exactly one where the kind has no list.
/// @param time [ns] of the measurement
void encode_reading(const SensorTypeInfo& kind, std::int64_t time, std::string_view frame,
                    std::span<const double> values, base::Bytes& out);

/// @param values as they were, element by element; reused for its capacity
/// @returns false when the bytes are no reading of that kind; the outputs are then half filled.
bool decode_reading(const SensorTypeInfo& kind, std::span<const std::uint8_t> message, std::int64_t& time,
                    std::vector<double>& values);

}  // namespace sf::record
