#include "apps/options/reading_elements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/bearing.h"
#include "sensors/infrared.h"
#include "sensors/laser_settings.h"
#include "sensors/sonar.h"
#include "viz/ticks.h"

namespace sf::apps {

namespace {

SensorElements cones_of(const std::vector<sensors::ConeArray>& arrays, std::uint32_t mover, std::uint32_t sensor) {
  for (const sensors::ConeArray& array : arrays) {
    if (array.row.mover != mover || array.row.sensor != sensor) continue;
    SensorElements elements{{}, array.range_min, array.range_max};
    for (const base::Pose& X_SC : array.X_SC) elements.bearings.push_back(X_SC.yaw);
    return elements;
  }
  return {};
}

SensorElements beams_of(const sensors::LaserSettings& laser) {
  SensorElements elements{{}, laser.range_min, laser.range_max};
  for (std::uint32_t i = 0; i < laser.samples; ++i)
    elements.bearings.push_back(base::bearing_of(laser.fov, laser.samples, i));
  return elements;
}

/// [deg] in (-180, 180], rounded to tenths.
double degrees_of(double bearing) {
  const double degrees = std::round(std::remainder(bearing, 2.0 * M_PI) * 1800.0 / M_PI) / 10.0 + 0.0;
  return degrees == -180.0 ? 180.0 : degrees;
}

}  // namespace

SensorElements elements_of(const world::World& world, const record::SensorTypeInfo& type, std::uint32_t mover,
                           std::uint32_t sensor) {
  if (type.id == sensors::kSonar)
    return cones_of(sensors::cone_arrays_of(world, "sonar", &sensors::read_sonar), mover, sensor);
  if (type.id == sensors::kInfrared)
    return cones_of(sensors::cone_arrays_of(world, "infrared", &sensors::read_infrared), mover, sensor);
  if (!type.is_scan) return {};
  const std::vector<sensors::LaserSettings> lasers = sensors::lasers_of(world.movers[mover]);
  return sensor < lasers.size() ? beams_of(lasers[sensor]) : SensorElements{};
}

std::vector<std::size_t> element_rows(const SensorElements& elements, std::size_t count, std::size_t every) {
  std::vector<std::size_t> rows;
  for (std::size_t e = 0; e < count; e += every) rows.push_back(e);
  if (elements.bearings.size() != count) return rows;
  std::stable_sort(rows.begin(), rows.end(), [&](std::size_t a, std::size_t b) {
    return degrees_of(elements.bearings[a]) > degrees_of(elements.bearings[b]);
  });
  return rows;
}

std::string bearing_name(const SensorElements& elements, std::size_t element) {
  if (element >= elements.bearings.size()) return std::to_string(element);
  return viz::with_minus(fmt::format("{:g}°", degrees_of(elements.bearings[element])));
}

}  // namespace sf::apps
