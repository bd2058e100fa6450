#pragma once
// The elements of a recorded sensor: their directions and range limits.

#include <cstdint>
#include <string>
#include <vector>

#include "sensors/sensor_set.h"

namespace sf::apps {

struct SensorElements {
  std::vector<double> bearings;  ///< [rad] in the sensor's frame, by element; empty if the elements have no bearing
  double range_min = 0.0;        ///< [m] of the column `range_m`
  double range_max = HUGE_VAL;   ///< [m] infinite: unknown
};

/// @param sensor 0-based index among the mover's sensors of that type
SensorElements elements_of(const sensors::SensorSet& sensor_set, std::uint8_t type, std::uint32_t mover,
                           std::uint32_t sensor);

/// Returns every `every`-th of `count` elements as rows from the top: sorted by bearing in (−180°, 180°] with the
/// leftmost first, or by index if the elements have no bearing.
std::vector<std::size_t> element_rows(const SensorElements& elements, std::size_t count, std::size_t every);

/// "−45°"; "3" if the element has no bearing.
std::string bearing_name(const SensorElements& elements, std::size_t element);

}  // namespace sf::apps
