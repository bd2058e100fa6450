#pragma once
// The ways of a world's robots, driven once and gone again: the same poses for whatever is measured along them.

#include <cstdint>
#include <vector>

#include "base/report.h"
#include "gpu/device.h"
#include "world/world.h"

namespace sf::scenarios {

/// Everyone's states, tick by tick.
using RecordedPaths = std::vector<std::vector<base::Report>>;

/// Wandering robots, `seconds` of simulated time, 1 to 1000 ticks.
RecordedPaths record_paths(const world::World& world, gpu::Device& device, double seconds, std::uint64_t seed,
                           unsigned threads);

}  // namespace sf::scenarios
