#pragma once
// Magnetometer arrays over many magnets: compares the farm with plain C++, and both with direct sums.

#include <cstdint>
#include <string>
#include <vector>

#include "bench/report.h"
#include "gpu/device.h"
#include "world/world.h"

namespace sf::bench {

/// Arrays of five elements on robots at random poses that differ in each turn, so that stale results are wrong.
struct FieldScene {
  std::string name;
  world::World world;
  std::size_t repeats = 0;
  std::vector<std::vector<base::Pose>> rounds;  ///< X_WM per turn and robot
};

/// `arrays` over SimVille's magnets, without a cut-off.
FieldScene simville_scene(std::uint32_t arrays, std::size_t repeats);
/// `arrays` over `magnets` at random positions, one per square metre.
FieldScene sheet_scene(std::uint32_t arrays, std::uint32_t magnets, double cutoff, std::size_t repeats);

/// Ratios are relative to plain C++.
Report compare_fields(const FieldScene& scene, gpu::Device& device);

}  // namespace sf::bench
