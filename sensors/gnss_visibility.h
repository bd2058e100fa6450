#pragma once
// Satellite visibility and dilution of precision.
//
// The constellation is fixed: satellite i of N has the azimuth (from x towards y) of i times the golden angle, and
// sin(elevation) rises from sin(15 degrees) to 1 in equal steps, with half a step at both ends. The distribution is
// uniform over the sky above the mask (Swinbank and Purser, "Fibonacci grids", Q. J. R. Meteorol. Soc. 132, 2006).
//
// A line of sight is straight. Static geometry that lasers detect or robots collide with blocks it. A surface blocks
// the line if the line crosses the surface within its range of heights. A solid overhead (a bridge, a roof) blocks the
// line if the line meets its underside within its outline. Movers do not block lines of sight.

#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/box_tree.h"
#include "world/wall_tree.h"
#include "world/world.h"

namespace sf::sensors {

/// Direction of one satellite, equal for all positions.
struct Satellite {
  glm::dvec2 horizontal;       ///< [-] unit vector of the azimuth
  double tan_elevation = 1.0;  ///< [-] > 0
};

/// Returns `count` satellites. @param count in [1, 64]
std::vector<Satellite> constellation(std::uint32_t count);

inline constexpr double kLeastElevation = 15.0 * M_PI / 180.0;  ///< [rad] smallest elevation in all constellations
/// Returns the largest height of geometry that blocks lines of sight [m]; -infinity if there is none.
double top_of_blocking(const world::World& world);

/// Position errors due to independent range errors of standard deviation 1, with unknown 3-D position and clock: (x, y)
/// = (xx n, yx n + yy m), z = zx x + zy y + zz o, with standard normal n, m and o.
struct Dilution {
  double xx = 0.0;
  double yx = 0.0;
  double yy = 0.0;
  double hdop = 0.0;  ///< horizontal dilution of precision: square root of the sum of both variances
  double zx = 0.0, zy = 0.0, zz = 0.0;
  double vdop = 0.0;  ///< vertical dilution of precision: deviation of z
};

/// Returns an empty value when fewer than four satellites are visible, or when all lie on one cone.
/// @param seen one bit per satellite
std::optional<Dilution> dilution(std::span<const Satellite> satellites, std::uint64_t seen);

/// Obstacles to lines of sight. Immutable and thread-safe.
class GnssVisibility {
 public:
  explicit GnssVisibility(const world::World& world);
  /// @param z [m] height of the antenna
  bool is_visible(glm::dvec2 p, double z, const Satellite& satellite) const;

 private:
  explicit GnssVisibility(std::vector<world::Segment> walls);

  struct Solid {
    std::uint32_t first = 0, last = 0;  ///< edges of its outline in `solid_edges_`
    double z_min = 0.0;
  };
  void add_solids(std::span<const world::Segment> walls);
  bool crosses(glm::dvec2 p, double z, const Satellite& satellite, const world::Segment& wall) const;
  bool under(glm::dvec2 p, double z, const Satellite& satellite, const Solid& solid) const;

  double piece_ = 1.0;  ///< [m] length of a line of sight that is tested in one step
  double z_top_ = 0.0;  ///< [m] largest height of any obstacle
  world::WallTree walls_;
  std::vector<world::Segment> solid_edges_;
  std::vector<Solid> solids_;
  base::BoxTree boxes_;  ///< of the solids
};

}  // namespace sf::sensors
