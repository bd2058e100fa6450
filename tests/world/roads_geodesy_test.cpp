// Degrees to metres, against distances over the ellipsoid computed another way.

#include "world/roads/geodesy.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"

namespace sf::world {
namespace {

/// Vincenty's inverse formula ("Direct and inverse solutions of geodesics on the ellipsoid", DeviceList Review 23,
/// 1975) in long double: the length of the geodesic and its azimuth at `a`, clockwise from north.
struct Geodesic {
  long double length, azimuth;
};
Geodesic geodesic(Geodetic a, Geodetic b) {
  const long double radius = 6378137.0L, f = 1.0L / 298.257222101L, minor = radius * (1 - f), deg = M_PIl / 180;
  const long double u1 = std::atan((1 - f) * std::tan(a.latitude * deg)),
                    u2 = std::atan((1 - f) * std::tan(b.latitude * deg));
  const long double dl = (static_cast<long double>(b.longitude) - a.longitude) * deg;
  long double lambda = dl, sin_s = 0, cos_s = 1, s = 0, cos2a = 1, cos2m = 0;
  for (int i = 0; i < 100; ++i) {
    const long double x = std::cos(u2) * std::sin(lambda);
    const long double y = std::cos(u1) * std::sin(u2) - std::sin(u1) * std::cos(u2) * std::cos(lambda);
    sin_s = std::sqrt(x * x + y * y);
    cos_s = std::sin(u1) * std::sin(u2) + std::cos(u1) * std::cos(u2) * std::cos(lambda);
    s = std::atan2(sin_s, cos_s);
    const long double sin_a = sin_s == 0 ? 0 : std::cos(u1) * std::cos(u2) * std::sin(lambda) / sin_s;
    cos2a = 1 - sin_a * sin_a;
    cos2m = cos2a == 0 ? 0 : cos_s - 2 * std::sin(u1) * std::sin(u2) / cos2a;
    const long double c = f / 16 * cos2a * (4 + f * (4 - 3 * cos2a));
    lambda = dl + (1 - c) * f * sin_a * (s + c * sin_s * (cos2m + c * cos_s * (2 * cos2m * cos2m - 1)));
  }
  const long double uu = cos2a * (radius * radius - minor * minor) / (minor * minor);
  const long double big_a = 1 + uu / 16384 * (4096 + uu * (-768 + uu * (320 - 175 * uu)));
  const long double big_b = uu / 1024 * (256 + uu * (-128 + uu * (74 - 47 * uu)));
  const long double ds = big_b * sin_s *
                         (cos2m + big_b / 4 *
                                      (cos_s * (2 * cos2m * cos2m - 1) -
                                       big_b / 6 * cos2m * (4 * sin_s * sin_s - 3) * (4 * cos2m * cos2m - 3)));
  return {minor * big_a * (s - ds),
          std::atan2(std::cos(u2) * std::sin(lambda),
                     std::cos(u1) * std::sin(u2) - std::sin(u1) * std::cos(u2) * std::cos(lambda))};
}

TEST(LocalPlane, OriginIsNought) {
  const glm::dvec2 p = LocalPlane({34.5, -117.4}).east_north({34.5, -117.4});
  EXPECT_EQ(p.x, 0.0);
  EXPECT_EQ(p.y, 0.0);
}

// Known lengths: radii of curvature times a small angle.
TEST(LocalPlane, DegreesOfKnownLength) {
  const double step = 1e-3;
  // One degree of longitude on the equator is 111 319.491 m; of latitude 110 574.276 m.
  EXPECT_NEAR(LocalPlane({0, 0}).east_north({0, step}).x, 111.319491, 1e-6);
  EXPECT_NEAR(LocalPlane({0, 0}).east_north({step, 0}).y, 110.574276, 1e-6);
  // At 45 degrees: longitude 78 846.835 m, latitude 111 131.778 m.
  EXPECT_NEAR(LocalPlane({45, 10}).east_north({45, 10 + step}).x, 78.846835, 1e-5);
  EXPECT_NEAR(LocalPlane({45, 10}).east_north({45 + step, 10}).y, 111.131778, 1e-5);
}

TEST(LocalPlane, SignsAndPoles) {
  EXPECT_GT(LocalPlane({-38, 145}).east_north({-38, 145.001}).x, 0.0);
  EXPECT_GT(LocalPlane({-38, 145}).east_north({-37.999, 145}).y, 0.0);
  EXPECT_NEAR(LocalPlane({0, 180}).east_north({0, -179.999}).x, 111.319491, 1e-6);      // over the date line
  EXPECT_NEAR(length(LocalPlane({90, 0}).east_north({89.999, 77})), 111.693980, 1e-4);  // a pole has all longitudes
}

// Distance and direction agree with the geodesic within the flattening the header states.
TEST(LocalPlane, AgreesWithGeodesics) {
  double worst = 0.0;
  for (std::uint32_t k = 0; k < 500; ++k) {
    const auto u = base::random_uniform({1, base::RandomStream::placement, k, 0, 0}, 0);
    const auto v = base::random_uniform({1, base::RandomStream::placement, k, 0, 0}, 1);
    const Geodetic origin{-80.0 + 160.0 * u[0], -180.0 + 360.0 * u[1]};
    const double reach = std::pow(10.0, -4.0 + 3.3 * v[0]);  // [deg] 10 m to 20 km
    const Geodetic at{origin.latitude + reach * std::sin(40.0 * v[1]),
                      origin.longitude + reach * std::cos(40.0 * v[1])};
    const glm::dvec2 flat = LocalPlane(origin).east_north(at);
    const Geodesic over = geodesic(origin, at);
    const double d = static_cast<double>(over.length);
    const double east = d * static_cast<double>(std::sin(over.azimuth));
    const double north = d * static_cast<double>(std::cos(over.azimuth));
    // Azimuths of geodesics and of straight lines differ in d^2 e^2 / R^2; Vincenty itself is good to 0.1 mm.
    const double allowed = 1.2 * d * d * d / (6.0 * 6371e3 * 6371e3) + 2e-4;
    EXPECT_NEAR(flat.x, east, allowed) << d;
    EXPECT_NEAR(flat.y, north, allowed) << d;
    worst = std::max(worst, length(flat - glm::dvec2{east, north}) / d);
  }
  EXPECT_LT(worst, 3e-5);
}

// Nine decimals of a degree are a tenth of a millimetre: nothing of them may be lost.
TEST(LocalPlane, SmallStepsAreNotRounded) {
  const LocalPlane plane({40.0, -83.0});
  const double step = 1.1103463e-4;  // [m] of 1e-9 degrees there: radius of curvature of the meridian, 6 361 815.8 m
  for (int i = 1; i < 1000; i += 7) EXPECT_NEAR(plane.east_north({40.0 + i * 1e-9, -83.0}).y, i * step, 5e-9);
}

}  // namespace
}  // namespace sf::world
