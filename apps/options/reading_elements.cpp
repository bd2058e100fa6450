#include "apps/options/reading_elements.h"

#include <fmt/format.h>

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

std::string element_name(const SensorElements& elements, std::size_t element) {
  if (element >= elements.bearings.size()) return std::to_string(element);
  const double degrees = std::round(std::remainder(elements.bearings[element], 2.0 * M_PI) * 1800.0 / M_PI) / 10.0;
  return fmt::format("{} ({}°)", element, viz::with_minus(fmt::format("{:g}", degrees + 0.0)));
}

}  // namespace sf::apps
