#include "world/roads/geodesy.h"

#include <cmath>

#include "base/elementary.h"

namespace sf::world {

namespace {

constexpr double kRadius = 6378137.0;                // [m] equatorial, GRS80 (and WGS84)
constexpr double kFlattening = 1.0 / 298.257222101;  // GRS80
constexpr double kDegree = M_PI / 180.0;

}  // namespace

LocalPlane::Earth LocalPlane::earth(Geodetic at) {
  const double e2 = kFlattening * (2.0 - kFlattening);
  const double sin_lat = base::sin(at.latitude * kDegree);
  const double cos_lat = base::cos(at.latitude * kDegree);
  const double normal = kRadius / std::sqrt(1.0 - e2 * sin_lat * sin_lat);
  return {normal * cos_lat * base::cos(at.longitude * kDegree), normal * cos_lat * base::sin(at.longitude * kDegree),
          normal * (1.0 - e2) * sin_lat};
}

LocalPlane::LocalPlane(Geodetic origin)
    : origin_(earth(origin)),
      sin_lat_(base::sin(origin.latitude * kDegree)),
      cos_lat_(base::cos(origin.latitude * kDegree)),
      sin_lon_(base::sin(origin.longitude * kDegree)),
      cos_lon_(base::cos(origin.longitude * kDegree)) {}

glm::dvec2 LocalPlane::east_north(Geodetic at) const {
  const Earth p = earth(at);
  const double dx = p.x - origin_.x;
  const double dy = p.y - origin_.y;
  const double dz = p.z - origin_.z;
  return {-sin_lon_ * dx + cos_lon_ * dy, -sin_lat_ * cos_lon_ * dx - sin_lat_ * sin_lon_ * dy + cos_lat_ * dz};
}

}  // namespace sf::world
