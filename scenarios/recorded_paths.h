#pragma once
// Records paths of a world's robots, so that several measurements use the same poses.

#include <cstdint>
#include <vector>

#include "base/report.h"
#include "gpu/device.h"
#include "world/world.h"

namespace sf::scenarios {

/// Reports of all movers, tick by tick.
using RecordedPaths = std::vector<std::vector<base::Report>>;

/// Returns paths of robots that wander for `seconds` of simulated time; 1 to 1000 ticks.
RecordedPaths record_paths(const world::World& world, gpu::Device& device, double seconds, std::uint64_t seed,
                           unsigned threads);

}  // namespace sf::scenarios
