#pragma once
// Rings of sonar: the farm beside plain C++ that casts the same rays through a grid and keeps the nearest, in turn.

#include <cstdint>
#include <string>
#include <vector>

#include "bench/cost.h"
#include "gpu/device.h"
#include "world/world.h"

namespace sf::bench {

/// Pioneers' rings in the cave, all transducers at once, seen by nobody. Robots turn and shift from round to round.
struct ConeScene {
  world::World world;
  std::vector<std::vector<base::Pose>> rounds;  ///< X_WM per round and robot
};

/// One method's part.
struct ConeMethodResult {
  std::string method;
  std::vector<Cost> repeats;
  Cost typical;            ///< medians
  double ratio = 0.0;      ///< [-] median over turns of plain C++'s time / its own
  double cpu_ratio = 0.0;  ///< [-] the same of time on all cores
  double worst = 0.0;      ///< [m] farthest from what the nearest of its rays may read, of a sample of all rounds
  std::uint64_t hash = 0;  ///< of all ranges of round 0
};

struct ConeComparison {
  std::size_t robots = 0;
  std::size_t cones = 0;
  std::size_t rays = 0;     ///< per turn
  std::size_t checked = 0;  ///< cones of each entrant
  std::vector<ConeMethodResult> method_results;
};

ConeScene make_cone_scene(std::uint32_t robots);

/// Every turn asks every method once for the same round, in an order that rotates; results are spoilt before and looked
/// at after.
ConeComparison compare_cones(gpu::Device& device, const ConeScene& scene, std::size_t repeats);

/// Writes cones.csv into `folder`; keeps the old one where nothing was measured.
/// @throws base::InputError when it cannot be written.
void write_cones(const std::vector<ConeComparison>& comparisons, const std::string& folder);
std::string cone_table(const std::vector<ConeComparison>& comparisons);

}  // namespace sf::bench
