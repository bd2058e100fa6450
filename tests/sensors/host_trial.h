#pragma once
// Hand-made sensors without device work, and tests common to all their types.

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "robots/fleet.h"
#include "sensors/sensor_set.h"
#include "tests/refusal.h"
#include "tests/sensors/compare.h"
#include "tests/sensors/magnet_scenes.h"
#include "tests/sensors/statistics.h"

namespace sf::trial {

using scenes::setting;
using scenes::text;

/// Returns a sensor of type `type` at line 7 of park.world, in metres and degrees. Its settings are on lines 8, 9, ...
inline world::Sensor fitted(const std::string& type, std::vector<world::Setting> settings = {}) {
  world::Sensor sensor;
  sensor.type = type;
  sensor.name = type;
  sensor.radians_per_unit = M_PI / 180.0;
  sensor.file = "park.world";
  sensor.line = 7;
  sensor.settings = std::move(settings);
  int line = 8;
  for (world::Setting& s : sensor.settings) s.file = "park.world", s.line = line++;
  return sensor;
}

/// Returns a world with robots at `poses`, each with `sensor`.
inline world::World carriers(const world::Sensor& sensor, const std::vector<base::Pose>& poses = {base::Pose{}}) {
  world::World world;
  for (const base::Pose& pose : poses) scenes::add_carrier(world, pose, sensor);
  return world;
}

inline std::vector<double> values_of(const base::ReadingBlock& reading) {
  return {reading.values.begin(), reading.values.end()};
}

/// Returns the values of the world's first reading.
inline std::vector<double> read_once(const world::World& world) { return values_of(Glance(world).readings[0]); }

/// Adds a static outline, solid inside, from `z_min` to `z_max` [m]; corners counter-clockwise.
inline void add_solid(world::World& world, const std::vector<glm::dvec2>& corners, double z_min, double z_max) {
  const auto model = static_cast<std::uint32_t>(world.models.size());
  world.models.push_back({"solid" + std::to_string(model), "model"});
  for (std::size_t i = 0; i < corners.size(); ++i)
    world.walls.push_back(
        {.a = corners[i], .b = corners[(i + 1) % corners.size()], .z_min = z_min, .z_max = z_max, .model = model});
}

inline std::vector<glm::dvec2> square(glm::dvec2 middle, double side) {
  const double h = 0.5 * side;
  return {{middle.x - h, middle.y - h},
          {middle.x + h, middle.y - h},
          {middle.x + h, middle.y + h},
          {middle.x - h, middle.y + h}};
}

/// Expects that settings are rejected at park.world:`line` with a message that contains `words`.
inline void expect_refused(const std::string& type, std::vector<world::Setting> settings, int line,
                           const std::string& words) {
  const std::string error =
      refusal_of([&] { sensors::SensorSet sensor_set(carriers(fitted(type, std::move(settings)))); });
  EXPECT_TRUE(error.starts_with("park.world:" + std::to_string(line) + ": ")) << error;
  expect_in(words, error);
}

}  // namespace sf::trial
