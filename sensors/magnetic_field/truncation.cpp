#include "sensors/magnetic_field/truncation.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <vector>

#include "sensors/magnetic_field/magnet_tree.h"
#include "sensors/magnetometer.h"
#include "sensors/magnetometer_modes.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

using base::Box;

constexpr double kRounding = 1.0 + 1e-6;        // rounding errors of sums, 32-bit moments and decisions at the cut-off
constexpr double kFinest = 0.25;                // fraction of the cut-off: smaller squares are not halved
constexpr std::size_t kMostSquares = 1u << 15;  // limit of the refinement

struct Square {
  Box box;
  double bound;
  bool operator<(const Square& other) const { return bound < other.bound; }
};

/// Returns a box outside which every magnet is beyond the cut-off, and farther away than from some point on the box's
/// edge.
Box around(const Box& magnets, double cutoff) {
  const double margin = 1.01 * cutoff;
  const glm::dvec2 middle = 0.5 * (magnets.min + magnets.max);
  const double half = margin + 0.5 * std::max(magnets.max.x - magnets.min.x, magnets.max.y - magnets.min.y) * kRounding;
  return {middle - glm::dvec2{half, half}, middle + glm::dvec2{half, half}};
}

/// Returns the largest bound over all squares. Repeatedly refines the square with the largest bound until it is small
/// enough.
double largest(const MagnetTree& tree, double cutoff) {
  const Box all = around(tree.extent(), cutoff);
  std::priority_queue<Square> squares;
  squares.push({all, tree.bound(all, cutoff)});
  for (std::size_t seen = 1; seen < kMostSquares; seen += 4) {
    const Square top = squares.top();
    const double half = 0.5 * (top.box.max.x - top.box.min.x);
    if (2.0 * half <= kFinest * cutoff || !(half > 0.0)) break;
    squares.pop();
    const glm::dvec2 middle = 0.5 * (top.box.min + top.box.max);
    for (const Box& quarter :
         {Box{top.box.min, middle}, Box{middle, top.box.max}, Box{{middle.x, top.box.min.y}, {top.box.max.x, middle.y}},
          Box{{top.box.min.x, middle.y}, {middle.x, top.box.max.y}}})
      squares.push({quarter, std::min(top.bound, tree.bound(quarter, cutoff))});
  }
  return squares.top().bound;
}

/// Returns the heights of all elements, each once.
std::vector<double> heights_of(const world::World& world) {
  std::vector<double> heights;
  for_each_of(world, magnetometer_type.word.type,
              [&](const world::Sensor& sensor, std::uint32_t mover, std::uint32_t /*number*/) {
                const auto own = element_heights(world.movers[mover], sensor);
                heights.insert(heights.end(), own.begin(), own.end());
              });
  std::sort(heights.begin(), heights.end());
  heights.erase(std::unique(heights.begin(), heights.end()), heights.end());
  return heights;
}

/// Returns the world with all magnets at one height, the worst case.
world::World flattened(const world::World& world) {
  world::World flat;
  flat.magnet_cutoff = world.magnet_cutoff;
  flat.magnets = world.magnets;
  for (world::Magnet& magnet : flat.magnets) magnet.z = 0.0;
  for (const world::Mover& mover : world.movers) {
    world::Mover carrier;
    carrier.magnets = mover.magnets;
    for (world::Magnet& magnet : carrier.magnets) magnet.z = 0.0;
    flat.movers.push_back(std::move(carrier));
  }
  return flat;
}

}  // namespace

double truncation_bound(const world::World& world, double height) {
  return truncation_bound(world, height, world.magnet_cutoff);
}

double truncation_bound(const world::World& world, double height, double nominal) {
  if (nominal == 0.0) return 0.0;
  const double cutoff = nominal / kRounding;
  double bound = world.magnets.empty() ? 0.0 : largest(MagnetTree(world.magnets, height), cutoff);
  for (const world::Mover& mover : world.movers) {
    // A mover's magnet contributes most at the cut-off distance.
    for (const world::Magnet& magnet : mover.magnets)
      bound += field_beyond(strength_of(magnet), cutoff, std::abs(height - mover.X_WM.z - magnet.z));
  }
  return kRounding * bound;
}

double truncation_bound_at_any_height(const world::World& world, double nominal) {
  return nominal == 0.0 ? 0.0 : truncation_bound(flattened(world), 0.0, nominal);
}

MagnetSummary summarize_magnets(const world::World& world) {
  MagnetSummary facts;
  facts.magnets = static_cast<std::uint32_t>(world.magnets.size());
  for (const world::Mover& mover : world.movers)
    facts.moving_magnets += static_cast<std::uint32_t>(mover.magnets.size());
  facts.cutoff_m = world.magnet_cutoff;
  const std::vector<double> heights = heights_of(world);
  if (heights.empty()) facts.bound_T = truncation_bound(flattened(world), 0.0);
  for (const double height : heights) {
    const double bound = truncation_bound(world, height);
    const bool worse = bound > facts.bound_T || height == heights.front();
    if (!worse) continue;
    facts.bound_T = bound;
    facts.height_m = height;
  }
  return facts;
}

}  // namespace sf::sensors
