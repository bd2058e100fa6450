#pragma once
// Hand-made sonar and infrared sensors for tests and benchmarks.

#include <cmath>
#include <string>
#include <vector>

#include "tests/units.h"
#include "world/world.h"

namespace sf::trial {

inline world::Setting cone_setting(const std::string& key, std::vector<double> numbers, const std::string& text = "") {
  return {key, std::move(numbers), text, 42, "made.world"};
}

/// A sensor of `type` with transducers at `poses` [m, rad], 0.1 m above its mover's base.
inline world::Sensor cones(const std::string& type, const std::vector<base::Pose>& poses,
                           std::vector<world::Setting> more = {}) {
  world::Sensor sensor;
  sensor.type = type;
  sensor.name = type;
  sensor.X_MS = {0.0, 0.0, 0.1, 0.0};
  sensor.file = "made.world";
  sensor.line = 7;
  sensor.settings = std::move(more);
  sensor.settings.push_back(cone_setting("scount", {static_cast<double>(poses.size())}));
  for (std::size_t i = 0; i < poses.size(); ++i)
    sensor.settings.push_back(
        cone_setting("spose3[" + std::to_string(i) + "]", {poses[i].x, poses[i].y, poses[i].z, poses[i].yaw}));
  return sensor;
}

/// Returns the poses of `count` transducers in a ring around a robot, at `radius` [m], facing outward.
inline std::vector<base::Pose> ring(std::uint32_t count, double radius) {
  std::vector<base::Pose> poses;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double yaw = 2.0 * M_PI * i / count;
    poses.push_back({radius * std::cos(yaw), radius * std::sin(yaw), 0.0, yaw});
  }
  return poses;
}

}  // namespace sf::trial
