#pragma once
// A small world for tests of the farm.

#include <vector>

#include "farm/farm.h"
#include "raycast/casters.h"
#include "sensors/laser_settings.h"
#include "tests/device.h"
#include "tests/sensors/scenes.h"

namespace sf::farm {

inline constexpr std::uint32_t kBeams = 61;

/// Runs lasers on the device's kernels, even on a software device.
inline const FarmOptions kOnDevice{.scene = {.caster = &raycast::device_caster}};

/// `robots` robots among boxes, each with one laser at 10 Hz.
inline world::World small_world(std::uint32_t robots, const raycast::ScanNoise& noise = {}) {
  world::World world = scenes::boxes(20, 12.0, 3);
  sensors::LaserSettings laser = scenes::laser(kBeams, M_PI, 8.0);
  laser.noise = noise;
  scenes::add_robots(world, robots, laser, 5);
  return world;
}

/// A copy of a reading.
struct Kept {
  std::uint32_t mover = 0, sensor = 0, sequence = 0;
  std::int64_t time = 0;
  std::vector<double> values;
  std::vector<std::uint32_t> hits;
  std::vector<base::QualityFlag> quality;
  double bound = 0.0;
  std::uint8_t mode = 0;
  bool operator==(const Kept&) const = default;
};

inline Kept keep(const base::ReadingBlock& r) {
  return {r.mover,
          r.sensor,
          r.sequence,
          r.time,
          {r.values.begin(), r.values.end()},
          {r.hits.begin(), r.hits.end()},
          {r.quality.begin(), r.quality.end()},
          r.bound,
          r.mode};
}

/// Reports of all robots, each driving a small circle from its pose at load.
inline std::vector<base::Report> reports_at(const world::World& world, int tick) {
  std::vector<base::Report> reports;
  for (std::uint32_t m = 0; m < world.movers.size(); ++m) {
    base::Pose X = world.movers[m].X_WM;
    X.x += 0.125 * (tick % 8);
    X.yaw += 0.25 * tick;
    reports.push_back({m, 0, X, {}});
  }
  return reports;
}

}  // namespace sf::farm
