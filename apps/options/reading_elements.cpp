#include "apps/options/reading_elements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sensors/infrared.h"
#include "sensors/sonar.h"
#include "viz/ticks.h"

namespace sf::apps {

namespace {

SensorElements cones_of(const sensors::ConeArray& array) {
  SensorElements elements{{}, array.range_min, array.range_max};
  for (const base::Pose& X_SC : array.X_SC) elements.bearings.push_back(X_SC.yaw);
  return elements;
}

SensorElements beams_of(const sensors::SensorSpec& laser) {
  SensorElements elements{{}, laser.range_min, laser.limit};
  for (std::uint32_t i = 0; i < laser.elements; ++i) elements.bearings.push_back(sensors::bearing_of(laser, i));
  return elements;
}

/// [deg] in (-180, 180], rounded to tenths.
double degrees_of(double bearing) {
  const double degrees = std::round(std::remainder(bearing, 2.0 * M_PI) * 1800.0 / M_PI) / 10.0 + 0.0;
  return degrees == -180.0 ? 180.0 : degrees;
}

}  // namespace

SensorElements elements_of(const sensors::SensorSet& sensor_set, std::uint8_t type, std::uint32_t mover,
                           std::uint32_t sensor) {
  const std::span<const sensors::SensorSpec> rows = sensor_set.of(type, mover);
  if (sensor >= rows.size()) return {};
  if (type == sensors::kSonar || type == sensors::kInfrared)
    return cones_of(sensor_set.settings_of<sensors::ConeArray>(type, mover)[sensor]);
  return sensor_set.group(type)->type->is_scan ? beams_of(rows[sensor]) : SensorElements{};
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
