#pragma once
// Which satellites a place sees, and what their geometry makes of their errors.
//
// The constellation stands still: satellite i of N is at the azimuth (from x towards y) of i times the golden angle,
// and sin(elevation) goes up from sin(15 degrees) in equal steps, half a step at both ends: even over the sky above the
// mask (Swinbank and Purser, "Fibonacci grids", Q. J. R. Meteorol. Soc. 132, 2006).
//
// A line of sight is straight. What stands still in the world, and lasers see or robots bump into, blocks it: a surface
// where the line crosses it in its range of heights, and a solid overhead (a bridge, a roof) where the line reaches its
// underside within its outline. Movers block nothing.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sensors/box_tree.h"
#include "world/wall_grid.h"
#include "world/world.h"

namespace sf::sensors {

/// Where one satellite stands, as seen from anywhere.
struct Satellite {
  glm::dvec2 horizontal;       ///< [-] unit vector along the ground
  double tan_elevation = 1.0;  ///< [-] > 0: tangent of its elevation
};

/// @param count in [1, 64]
std::vector<Satellite> constellation(std::uint32_t count);

/// What position errors come of independent range errors of standard deviation 1 to each satellite, when the position
/// in three dimensions and the clock are unknown: (x, y) = (xx n, yx n + yy m), n and m standard normal.
struct Dilution {
  double xx = 0.0;
  double yx = 0.0;
  double yy = 0.0;
  double hdop = 0.0;  ///< horizontal dilution of precision: root of the sum of both variances
};

/// Nothing where fewer than four are seen, or all on one cone.
/// @param seen one bit for each satellite
std::optional<Dilution> dilution(std::span<const Satellite> satellites, std::uint64_t seen);

/// What stands between places and the sky. Immutable; any thread.
class GnssVisibility {
 public:
  explicit GnssVisibility(const world::World& world);
  /// @param z [m] height of the antenna
  bool is_visible(glm::dvec2 p, double z, const Satellite& satellite) const;

 private:
  explicit GnssVisibility(std::vector<world::Segment> walls);

  struct Solid {
    std::uint32_t first = 0, last = 0;  ///< edges of its outline, in solid_edges_
    double z_min = 0.0;
  };
  void add_solids(std::span<const world::Segment> walls);
  bool crosses(glm::dvec2 p, double z, const Satellite& satellite, const world::Segment& wall) const;
  bool under(glm::dvec2 p, double z, const Satellite& satellite, const Solid& solid) const;

  double cell_ = 1.0;
  double z_top_ = 0.0;  ///< [m] nothing reaches higher
  world::WallGrid walls_;
  std::vector<world::Segment> solid_edges_;
  std::vector<Solid> solids_;
  BoxTree boxes_;  ///< of the solids
};

}  // namespace sf::sensors
