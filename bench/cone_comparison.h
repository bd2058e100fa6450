#pragma once
// Sonar rings: compares the farm with plain C++ that casts the same rays through a grid and keeps the nearest hit.

#include <cstdint>
#include <string>
#include <vector>

#include "bench/cost.h"
#include "gpu/device.h"
#include "world/world.h"

namespace sf::bench {

/// Sonar rings of Pioneers in the cave, all transducers firing at once, robots invisible to each other. Poses change by
/// round.
struct ConeScene {
  world::World world;
  std::vector<std::vector<base::Pose>> rounds;  ///< X_WM per round and robot
};

/// Result of one method.
struct ConeMethodResult : Timing {
  double worst = 0.0;      ///< [m] largest error relative to the nearest ray, over a sample of all rounds
  std::uint64_t hash = 0;  ///< of all ranges of round 0
};

struct ConeComparison {
  std::size_t robots = 0;
  std::size_t cones = 0;
  std::size_t rays = 0;                          ///< per turn
  std::size_t checked = 0;                       ///< number of cones per method
  std::vector<ConeMethodResult> method_results;  ///< ratios are relative to plain C++
};

ConeScene make_cone_scene(std::uint32_t robots);

/// In every turn, each method measures the same round once, in rotating order; results are poisoned before and checked
/// after it.
ConeComparison compare_cones(gpu::Device& device, const ConeScene& scene, std::size_t repeats);

/// Writes cones.csv into `folder`; without measurements, keeps the old file.
/// @throws base::InputError if it cannot be written
void write_cones(const std::vector<ConeComparison>& comparisons, const std::string& folder);
std::string cone_table(const std::vector<ConeComparison>& comparisons);

}  // namespace sf::bench
