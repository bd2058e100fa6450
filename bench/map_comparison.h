#pragma once
// Integration of scans into the maps of a fleet: compares the farm's batch with the plain mapper on all cores.

#include <cstdint>

#include "bench/report.h"
#include "gpu/device.h"

namespace sf::bench {

/// Ratios are relative to the plain mapper. In every turn, each method receives the same scans once, in rotating order:
/// robots in the cave, each with a separate map of 3 cm cells that covers its range.
Report compare_maps(gpu::Device& device, std::uint32_t robots, double range, bool weighs, std::size_t repeats);

}  // namespace sf::bench
