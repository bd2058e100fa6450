#pragma once
// What a cut-off leaves out, bounded for every place a sensor may be.

#include <cstdint>

#include "world/world.h"

namespace sf::sensors {

/// [T] least upper bound we can prove of |B - B_cut| over all places at `height` [m], wherever movers are: with the
/// world's own cut-off, or 0 where it has none. Covers magnets at the rim that rounding decides, too.
///
/// A magnet beyond the cut-off R adds at most |B| = k sqrt(rho^2 + 4 h^2) / (rho^2 + h^2)^2 at rho along the ground and
/// h above it, which falls with rho and with |h|. So a tree of magnets bounds the sum for all places of a square at
/// once, and squares are halved where that sum is largest, down to a quarter of R. Movers' magnets count in full at R.
double truncation_bound(const world::World& world, double height);
/// With another cut-off [m]; 0: none.
double truncation_bound(const world::World& world, double height, double cutoff);

/// What `check` says of a world's magnets.
struct MagnetSummary {
  std::uint32_t magnets = 0;         ///< that stand still
  std::uint32_t moving_magnets = 0;  ///< that movers carry
  double cutoff_m = 0.0;             ///< 0: all count
  double bound_T = 0.0;              ///< what the cut-off may leave out at most
  double height_m = 0.0;  ///< where that bound holds: the worst of the magnetometers' elements; none: of all heights
};

/// @throws base::InputError for a magnetometer whose settings make no sense.
MagnetSummary summarize_magnets(const world::World& world);

}  // namespace sf::sensors
