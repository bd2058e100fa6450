#pragma once
// The elements of a recorded sensor: where they look, and the limits of their ranges.

#include <cstdint>
#include <string>
#include <vector>

#include "record/run_info.h"
#include "world/world.h"

namespace sf::apps {

struct SensorElements {
  std::vector<double> bearings;  ///< [rad] in the sensor's frame, by element; empty where elements have none
  double range_min = 0.0;        ///< [m] of a column `range_m`
  double range_max = HUGE_VAL;   ///< [m] infinite: no limit is known
};

/// @param sensor 0-based among the mover's sensors of that type
SensorElements elements_of(const world::World& world, const record::SensorTypeInfo& type, std::uint32_t mover,
                           std::uint32_t sensor);

/// Every `every`-th of `count` elements as rows from above: by bearing in (−180°, 180°], the leftmost first; in the
/// order of their numbers where they have none.
std::vector<std::size_t> element_rows(const SensorElements& elements, std::size_t count, std::size_t every);

/// "−45°"; "3" where it has no bearing.
std::string bearing_name(const SensorElements& elements, std::size_t element);

}  // namespace sf::apps
