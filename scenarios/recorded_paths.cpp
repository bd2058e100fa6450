#include "scenarios/recorded_paths.h"

#include <algorithm>
#include <cmath>

#include "scenarios/simulation.h"

namespace sf::scenarios {

RecordedPaths record_paths(const world::World& world, gpu::Device& device, double seconds, std::uint64_t seed,
                           unsigned threads) {
  Simulation simulation(world, device, {.seed = seed, .threads = threads});
  RecordedPaths paths;
  const auto ticks = std::clamp<std::int64_t>(std::llround(seconds / world.interval), 1, 1000);
  for (std::int64_t tick = 0; tick < ticks; ++tick) {
    const base::TickRecord record = simulation.step();
    paths.emplace_back(record.reports.begin(), record.reports.end());
  }
  return paths;
}

}  // namespace sf::scenarios
