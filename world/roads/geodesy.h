#pragma once
// Converts degrees to metres in a plane that touches the ellipsoid at an origin, with x east and y north.
//
// A position on the ellipsoid (GRS80, height 0) is converted exactly, in double, to Earth-centred coordinates and then
// to the plane (B. Hofmann-Wellenhof et al., "GNSS", 2008, ch. 8). The vertical projection onto the plane flattens the
// Earth: a distance d from the origin is too short by d^3 / (6 R^2), R = 6371 km: 4 um at 1 km, 4 mm at 10 km, 3 cm at
// 20 km, 4 m at 100 km. The files have no heights; distances on ground at height H are larger than here by H / R
// (1.6e-4 at 1 km). Using WGS84 instead of GRS80 changes positions by less than 1e-10 of their distance.

#include "base/pose.h"

namespace sf::world {

/// Invariant: latitude in [-90, 90], longitude in [-180, 180].
struct Geodetic {
  double latitude = 0.0;   ///< [deg] north positive
  double longitude = 0.0;  ///< [deg] east positive
};

class LocalPlane {
 public:
  explicit LocalPlane(Geodetic origin);

  /// Returns the position [m] east and north of the origin. The rounding error is below 1e-8 m.
  glm::dvec2 east_north(Geodetic at) const;

 private:
  struct Earth {
    double x = 0.0, y = 0.0, z = 0.0;  ///< [m] Earth-centred, z towards the north pole
  };
  static Earth earth(Geodetic at);

  Earth origin_;
  double sin_lat_, cos_lat_, sin_lon_, cos_lon_;
};

}  // namespace sf::world
