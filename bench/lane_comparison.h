#pragma once
// Compares whole ticks of lane edge sensors with the same algorithm in plain C++ on all cores.

#include "bench/lane_scene.h"
#include "bench/report.h"
#include "gpu/device.h"

namespace sf::bench {

/// In every turn, each method reads the same round once, in rotating order; results are poisoned before it. The
/// reference for exact markings is the tests' brute force with the fit on the host, for a sample of sensors. The
/// reference for a raster is plain C++, which traverses it in 64 bits.
Report compare_lanes(gpu::Device& device, const LaneScene& scene, std::size_t repeats);

}  // namespace sf::bench
