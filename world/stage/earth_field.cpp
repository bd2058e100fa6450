#include "world/stage/earth_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "world/roads/sidecar.h"

namespace sf::world {

namespace {

constexpr double kGauss = 1e-4;      // [T]
constexpr double kMostGauss = 1e6;   // of a component
constexpr double kEarthGauss = 1.0;  // more than anywhere on the Earth: 0.22 to 0.67
constexpr double kDegree = M_PI / 180.0;

struct Location {
  Geodetic at;
  double heading = 0.0;  ///< [rad] direction of east in the world
};

Location location_of_road(const BuildState& b, const Property& property) {
  std::vector<Warning> known;  // from the load of the road
  const RoadSidecar sidecar = b.world.road_files.empty() ? RoadSidecar{} : read_sidecar(b.world.road_files[0], known);
  if (!sidecar.origin)
    fail(b.context, property.at,
         b.world.road_files.empty()
             ? "'earth_location' is \"road\", but the world has no road( rndf ); expected [latitude longitude]"
             : fmt::format("'earth_location' is \"road\", but no sidecar of {} states an 'origin'; expected one, or "
                           "[latitude longitude] here",
                           b.world.road_files[0]));
  return {*sidecar.origin, sidecar.heading};
}

Location read_location(BuildState& b, const Entity& root, const Property& property) {
  constexpr const char* kExpected = "[latitude longitude heading] in degrees";
  if (property.values.size() == 1 && property.values[0].is_text) {
    if (property.values[0].text == "road") return location_of_road(b, property);
    fail(b.context, property.at,
         fmt::format("'earth_location' is \"{}\"; expected {}, or \"road\"", property.values[0].text, kExpected));
  }
  const std::vector<double> v = *tuple(b.context, root, "earth_location", 2, kExpected);
  const double heading = v.size() > 2 ? v[2] : 0.0;
  if (std::abs(v[0]) > 90.0 || std::abs(v[1]) > 180.0 || std::abs(heading) > 360.0)
    fail(b.context, property.at,
         fmt::format("'earth_location' is [{:g} {:g} {:g}]; expected a latitude from -90 to 90 (north positive), a "
                     "longitude from -180 to 180 (east positive) and a heading from -360 to 360",
                     v[0], v[1], heading));
  return {{v[0], v[1]}, kDegree * heading};
}

glm::dvec3 read_vector(BuildState& b, const Entity& root, const Property& property) {
  const std::vector<double> v = *tuple(b.context, root, "earth_field", 3, "[x y z] in Gauss");
  const double most = std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])});
  if (most > kMostGauss)
    fail(b.context, property.at, fmt::format("'earth_field' is {:g} Gauss; expected at most {:g}", most, kMostGauss));
  if (most > kEarthGauss)
    warn(
        b.context, property.at,
        fmt::format("'earth_field' is in Gauss, and {:g} is more than anywhere on the Earth (0.22 to 0.67): write {:g} "
                    "if it is in microtesla",
                    most, 0.01 * most));
  return {kGauss * v[0], kGauss * v[1], kGauss * v[2]};
}

}  // namespace

glm::dvec3 dipole_field(double latitude, double longitude) {
  constexpr double g10 = -29404.8e-9, g11 = -1450.9e-9, h11 = 4652.5e-9;  // [T]
  const double sin_lat = base::sin(kDegree * latitude), cos_lat = base::cos(kDegree * latitude);
  const double sin_lon = base::sin(kDegree * longitude), cos_lon = base::cos(kDegree * longitude);
  const double across = g11 * cos_lon + h11 * sin_lon;
  return {g11 * sin_lon - h11 * cos_lon, across * sin_lat - g10 * cos_lat, 2.0 * (g10 * sin_lat + across * cos_lat)};
}

void read_earth_field(BuildState& b, const Entity& root) {
  const Property* field = find(root, "earth_field");
  const Property* place = find(root, "earth_location");
  if (field != nullptr && place != nullptr)
    fail(b.context, place->at, "both 'earth_field' and 'earth_location'; expected one of them");
  if (field != nullptr) b.world.earth_field = read_vector(b, root, *field);
  if (place == nullptr) return;
  const Location location = read_location(b, root, *place);
  const glm::dvec3 east_north_up = dipole_field(location.at.latitude, location.at.longitude);
  const glm::dvec2 plane = base::rotate(location.heading, {east_north_up.x, east_north_up.y});
  b.world.earth_field = {plane.x, plane.y, east_north_up.z};
}

}  // namespace sf::world
