#pragma once
// Degrees to metres: a plane that touches the ellipsoid at an origin, x east, y north.
//
// A position goes from the ellipsoid (GRS80, height 0) to Earth-centred coordinates and from there into the plane,
// exactly, in double (B. Hofmann-Wellenhof et al., "GNSS", 2008, ch. 8). Looking down on the plane flattens the Earth:
// a distance d from the origin comes out short by d^3 / (6 R^2), R = 6371 km: 4 um at 1 km, 4 mm at 10 km, 3 cm at 20
// km, 4 m at 100 km. Heights are not in these files; ground at height H is larger than what is drawn by H / R (16 parts
// in 100 000 at 1 km). WGS84 in place of GRS80 moves nothing by more than 1e-10 of its distance.

#include "base/pose.h"

namespace sf::world {

/// Rule: latitude in [-90, 90], longitude in [-180, 180].
struct Geodetic {
  double latitude = 0.0;   ///< [deg] north positive
  double longitude = 0.0;  ///< [deg] east positive
};

class LocalPlane {
 public:
  explicit LocalPlane(Geodetic origin);

  /// [m] east and north of the origin; rounding is below 1e-8 m.
  glm::dvec2 east_north(Geodetic at) const;

 private:
  struct Earth {
    double x = 0.0, y = 0.0, z = 0.0;  ///< [m] Earth-centred, z to the north pole
  };
  static Earth earth(Geodetic at);

  Earth origin_;
  double sin_lat_, cos_lat_, sin_lon_, cos_lon_;
};

}  // namespace sf::world
