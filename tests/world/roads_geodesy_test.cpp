// Conversion of degrees to metres, compared with GeographicLib's geodesics on the same ellipsoid (GRS 80).

#include "world/roads/geodesy.h"

#include <gtest/gtest.h>

#include <GeographicLib/Geodesic.hpp>
#include <cmath>

#include "base/random.h"

namespace sf::world {
namespace {

TEST(LocalPlane, DateLineAndPoles) {
  EXPECT_NEAR(LocalPlane({0, 180}).east_north({0, -179.999}).x, 111.319491, 1e-6);  // over the date line
  EXPECT_NEAR(length(LocalPlane({90, 0}).east_north({89.999, 77})), 111.693980,
              1e-4);  // all longitudes are equal at a pole
}

// Distance and direction agree with the geodesic within the flattening stated in geodesy.h.
TEST(LocalPlane, AgreesWithGeodesics) {
  const GeographicLib::Geodesic ellipsoid(6378137.0, 1.0 / 298.257222101);
  double worst = 0.0;
  for (std::uint32_t k = 0; k < 500; ++k) {
    const auto u = base::random_uniform({1, base::RandomStream::placement, k, 0, 0}, 0);
    const auto v = base::random_uniform({1, base::RandomStream::placement, k, 0, 0}, 1);
    const Geodetic origin{-80.0 + 160.0 * u[0], -180.0 + 360.0 * u[1]};
    const double reach = std::pow(10.0, -4.0 + 3.3 * v[0]);  // [deg] 10 m to 20 km
    const Geodetic at{origin.latitude + reach * std::sin(40.0 * v[1]),
                      origin.longitude + reach * std::cos(40.0 * v[1])};
    const glm::dvec2 flat = LocalPlane(origin).east_north(at);
    double d = 0.0, azimuth = 0.0, arriving = 0.0;  // [m], [degrees] clockwise from north
    ellipsoid.Inverse(origin.latitude, origin.longitude, at.latitude, at.longitude, d, azimuth, arriving);
    const double east = d * std::sin(azimuth * M_PI / 180.0), north = d * std::cos(azimuth * M_PI / 180.0);
    // Azimuths of geodesics and of straight lines differ by d^2 e^2 / R^2; degrees are rounded to 10 nm.
    const double allowed = 1.2 * d * d * d / (6.0 * 6371e3 * 6371e3) + 1e-7;
    EXPECT_NEAR(flat.x, east, allowed) << d;
    EXPECT_NEAR(flat.y, north, allowed) << d;
    worst = std::max(worst, length(flat - glm::dvec2{east, north}) / d);
  }
  EXPECT_LT(worst, 3e-5);
}

// The ninth decimal of a degree is a tenth of a millimetre, which must be preserved.
TEST(LocalPlane, SmallStepsAreNotRounded) {
  const LocalPlane plane({40.0, -83.0});
  const double step = 1.1103463e-4;  // [m] of 1e-9 degrees there: the meridian's radius of curvature is 6361815.8 m
  for (int i = 1; i < 1000; i += 7) EXPECT_NEAR(plane.east_north({40.0 + i * 1e-9, -83.0}).y, i * step, 5e-9);
}

}  // namespace
}  // namespace sf::world
