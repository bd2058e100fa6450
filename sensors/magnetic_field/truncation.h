#pragma once
// Error bound of the magnet cut-off, for every point that a sensor may reach.

#include <cstdint>

#include "world/world.h"

namespace sf::sensors {

/// Returns an upper bound [T] of |B - B_cut| over all points at `height` [m] and all poses of movers, with the world's
/// cut-off; 0 without one. Covers magnets at the cut-off distance whose inclusion depends on rounding.
///
/// A magnet beyond the cut-off R contributes at most |B| = k sqrt(rho^2 + 4 h^2) / (rho^2 + h^2)^2 at the horizontal
/// distance rho and height h, which decreases with rho and |h|. So a tree of magnets bounds the sum for all points of a
/// square, and squares are halved where the sum is largest, down to a quarter of R. Movers' magnets count in full at R.
double truncation_bound(const world::World& world, double height);
/// Same with another cut-off [m]; 0: none.
double truncation_bound(const world::World& world, double height, double cutoff);
/// Same for points and movers at any heights.
double truncation_bound_at_any_height(const world::World& world, double cutoff);

/// Summary of a world's magnets for the command `check`.
struct MagnetSummary {
  std::uint32_t magnets = 0;         ///< static
  std::uint32_t moving_magnets = 0;  ///< carried by movers
  double cutoff_m = 0.0;             ///< 0: none
  double bound_T = 0.0;              ///< bound of the cut-off's error
  double height_m = 0.0;  ///< height of the bound: the worst of all elements' heights or, without magnetometers, of all
                          ///< heights
};

/// @throws base::InputError for a magnetometer with invalid settings
MagnetSummary summarize_magnets(const world::World& world);

}  // namespace sf::sensors
