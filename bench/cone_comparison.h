#pragma once
// Sonar rings: compares the farm with plain C++ that casts the same rays through a grid and keeps the nearest hit.

#include <cstdint>
#include <vector>

#include "bench/report.h"
#include "gpu/device.h"
#include "world/world.h"

namespace sf::bench {

/// Sonar rings of Pioneers in the cave, all transducers firing at once, robots invisible to each other. Poses change by
/// round.
struct ConeScene {
  world::World world;
  std::vector<std::vector<base::Pose>> rounds;  ///< X_WM per round and robot
};

ConeScene make_cone_scene(std::uint32_t robots);

/// Ratios are relative to plain C++. In every turn, each method measures the same round once, in rotating order;
/// results are poisoned before and checked after it.
Report compare_cones(gpu::Device& device, const ConeScene& scene, std::size_t repeats);

}  // namespace sf::bench
