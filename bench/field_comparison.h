#pragma once
// Magnetometer arrays over many magnets: compares the farm with plain C++, and both with direct sums.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "bench/cost.h"
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

/// Result of one method.
struct FieldMethodResult : Timing {
  double max_error = 0.0;   ///< relative to the largest field, over a sample of all turns
  std::size_t checked = 0;  ///< number of elements
};

struct FieldComparison {
  std::string scene;
  std::size_t arrays = 0;
  std::size_t magnets = 0;
  double cutoff_m = 0.0;
  double pairs = 0.0;                             ///< pairs of a magnet and an element that the farm sums per turn
  std::vector<FieldMethodResult> method_results;  ///< ratios are relative to plain C++
};

/// `arrays` over SimVille's magnets, without a cut-off.
FieldScene simville_scene(std::uint32_t arrays, std::size_t repeats);
/// `arrays` over `magnets` at random positions, one per square metre.
FieldScene sheet_scene(std::uint32_t arrays, std::uint32_t magnets, double cutoff, std::size_t repeats);

FieldComparison compare(const FieldScene& scene, gpu::Device& device);

/// Writes field.csv into `folder`; without measurements, keeps the old file.
/// @throws base::InputError if it cannot be written
void write_csv(const std::vector<FieldComparison>& comparisons, const std::string& folder);
std::string table(const std::vector<FieldComparison>& comparisons);

}  // namespace sf::bench
