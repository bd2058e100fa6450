#pragma once
// Readings of one sensor over time, of robots that stand still.

#include <vector>

#include "base/time.h"
#include "farm/farm.h"
#include "sensors/sensor_set.h"
#include "tests/device.h"
#include "world/stage/build_world.h"

namespace sf::trial {

inline world::World world_of(const std::string& text) {
  return world::build_world("trial.world", text, {.sensors = sensors::world_file_words()});
}

/// Returns the first readings of a sensor of the world's first robot, in ticks of 0.1 s.
inline std::vector<std::vector<double>> series(const world::World& world, std::uint8_t type, std::size_t readings,
                                               std::uint64_t seed = 1, const std::vector<farm::Fault>& faults = {},
                                               std::uint32_t sensor = 0) {
  farm::Farm farm(world, host_device(), {.seed = seed, .threads = 1, .faults = faults});
  farm.subscribe(0, base::only(type));
  std::vector<base::Report> reports;
  for (std::uint32_t m = 0; m < world.movers.size(); ++m) reports.push_back({m, 0, world.movers[m].X_WM, {}});
  std::vector<std::vector<double>> all;
  for (std::int64_t tick = 0; all.size() < readings; ++tick) {
    const std::int64_t now = tick * 100'000'000;
    for (base::Report& report : reports) report.time = now;
    for (const base::ReadingBlock& block : farm.tick(now, reports))
      if (block.mover == 0 && block.type == type && block.sensor == sensor && all.size() < readings)
        all.emplace_back(block.values.begin(), block.values.end());
  }
  return all;
}

}  // namespace sf::trial
