// Magnets at all distances and with all moments, and cancelling pairs.

#include <fmt/format.h>

#include <array>

#include "selftest/suite.h"
#include "sensors/magnetic_field/sampling.h"
#include "sensors/magnetometer.h"

namespace sf::selftest {

namespace {

using sensors::FieldPoint;

constexpr double kMoments[] = {1e-12, 1e-6, 1.0, 1e6, 1e12};  ///< [A m^2]
constexpr double kDistances[] = {1e-6, 1e-3, 1.0, 1e3, 1e6};  ///< [m]

struct Field {
  Real x = 0, y = 0, z = 0, magnitudes = 0;
};

/// Adds the field of a dipole along +z with the device's 32-bit moment. Within its radius: the field at the radius.
void add(const world::Magnet& m, const FieldPoint& p, Field& sum) {
  Real x = Real{p.x} - m.p.x, y = Real{p.y} - m.p.y, z = Real{p.z} - m.z;
  Real r = std::sqrt(x * x + y * y + z * z);
  if (r == 0) z = r = m.radius;
  const Real grown = r < m.radius ? m.radius / r : 1;
  x *= grown, y *= grown, z *= grown, r *= grown;
  const Real k = 1e-7 * static_cast<Real>(static_cast<float>(m.moment)) / (r * r * r * r * r);
  const Real bx = 3 * k * x * z, by = 3 * k * y * z, bz = k * (2 * z * z - x * x - y * y);
  sum.x += bx, sum.y += by, sum.z += bz;
  sum.magnitudes += std::sqrt(bx * bx + by * by + bz * bz);
}

/// Allowed errors relative to the sum of magnitudes: 1e-13, from three squared 32-bit errors of a root, and the effect
/// of the height of 1e-18 m that avoids a division by zero at a magnet's centre, to the third power.
double allowed_at(const world::World& world, const FieldPoint& p) {
  double nearest = HUGE_VAL;
  for (const world::Magnet& m : world.magnets) {
    const double r = std::hypot(p.x - m.p.x, p.y - m.p.y, p.z - m.z);
    if (r > 0.0) nearest = std::min(nearest, r);
  }
  return 1e-13 + 4e-18 / nearest;
}

void compare(Fixture& fixture, Checks& checks, const world::World& world, std::span<const FieldPoint> points,
             const std::string& what) {
  const auto sums = sensors::sample_field(world, fixture.device(), points, {.magnitudes = true});
  for (std::size_t i = 0; i < points.size(); ++i) {
    Field exact;
    for (const world::Magnet& m : world.magnets) add(m, points[i], exact);
    const Real apart = std::hypot(sums[i].x - exact.x, sums[i].y - exact.y, sums[i].z - exact.z);
    const double allowed = allowed_at(world, points[i]);
    checks.near(static_cast<double>(apart / exact.magnitudes), 0, allowed, what + ", vector", i);
    checks.near(static_cast<double>(sums[i].magnitudes / exact.magnitudes), 1, allowed, what + ", magnitudes", i);
  }
}

void one_magnet(Fixture& fixture, Checks& checks) {
  for (const double moment : kMoments) {
    world::World world;
    world.magnets.push_back({{}, 0.0, moment, 1e-9, 0});
    std::vector<FieldPoint> points;
    for (const double r : kDistances)
      for (const glm::dvec2& d : {glm::dvec2{1.0, 0.0}, glm::dvec2{0.6, 0.8}, glm::dvec2{0.0, 1.0},
                                  glm::dvec2{-0.8, -0.6}, glm::dvec2{0.0, -1.0}})
        points.push_back({r * d.x, 0.0, r * d.y});
    compare(fixture, checks, world, points, fmt::format("{:g} A m^2", moment));
  }
}

/// At a magnet's centre and within its radius: the field at the radius in the same direction; at the centre, the field
/// above it.
void within_it(Fixture& fixture, Checks& checks) {
  for (const double far : {0.0, 1e5, 1e7}) {
    world::World world;
    world.magnets.push_back({{far, -far}, 0.5, -2.0, 0.0125, 0});
    const std::array<FieldPoint, 6> points{{{far, -far, 0.5},
                                            {far + 0x1p-20, -far, 0.5},
                                            {far, -far, 0.5 + 1e-6},
                                            {far + 0x1p-10, -far + 0x1p-10, 0.5 - 0x1p-9},
                                            {far, -far + 0x1p-20, 0.5},
                                            {far, -far, 0.51}}};
    compare(fixture, checks, world, points, fmt::format("{:g} m away", far));
  }
}

void far_origins(Fixture& fixture, Checks& checks) {
  for (const double far : {0.0, 1e5, 1e7}) {
    world::World world;
    for (int i = 0; i < 200; ++i) world.magnets.push_back({{far + 0.071 * i, far}, 0.0, i % 3 ? 1.0 : -2.5, 0.0125, 0});
    std::vector<FieldPoint> points;
    for (int i = 0; i < 25; ++i) points.push_back({far + 0.6 * i, far + 0.01 * i, 0.075});
    compare(fixture, checks, world, points, fmt::format("200 magnets {:g} m away", far));
  }
}

/// Opposite pairs at one place, also a million times stronger: the result is zero, or the field of the magnet without a
/// partner.
void cancelling_pairs(Fixture& fixture, Checks& checks) {
  world::World world;
  for (int i = 0; i < 500; ++i)
    for (const double sign : {1.0, -1.0})
      world.magnets.push_back({{0.071 * i, 0.25}, 0.1, sign * (1.0 + 1e6 * (i % 2)), 0.0125, 0});
  std::vector<FieldPoint> points;
  for (int i = 0; i < 50; ++i) points.push_back({0.7 * i, -0.1, 0.3});
  const auto sums = sensors::sample_field(world, fixture.device(), points, {.magnitudes = true});
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (const double component : {sums[i].x, sums[i].y, sums[i].z})
      checks.same(component + 0.0, 0.0, "nothing is left", i);
    checks.holds(sums[i].magnitudes > 0.0, "their magnitudes are", i);
  }
  world.magnets.push_back({{3.0, 0.0}, 0.0, 1e-3, 0.0125, 0});
  compare(fixture, checks, world, points, "one without a partner");
}

/// Readings saturate at the sensor's limit and are always finite.
void saturated(Fixture& fixture, Checks& checks) {
  for (const double moment : {1e12, -1e12, 1e-12}) {
    world::World world;
    const std::uint32_t m = add_mover(world, {});
    world.magnets.push_back({{0.0, 0.0}, 0.2, moment, 1e-6, 0});
    world.movers[m].sensors.push_back(
        sensor("magnetometer", {{"scount", {2}}, {"spose3[0]", {0, 0, 0, 0}}, {"spose3[1]", {1e-6, 0, 1e-6, 0}}}, 0.2));
    world.movers[m].sensors[0].X_MS.z = 0.1;
    const TestFarm test = fixture.measure(world);
    const double most = 2147483647e-8;
    for (std::size_t e = 0; e < 2; ++e) {
      const auto row =
          test.readings[0].values.subspan(sensors::kMagnetometerColumns * e, sensors::kMagnetometerColumns);
      for (const double value : row)
        checks.holds(std::isfinite(value) && std::fabs(value) <= most + 1e-14, "within its sensitivity", e);
      if (std::fabs(moment) > 1.0) checks.near(row[0], most, 1e-14, "saturated", e);
      if (std::fabs(moment) > 1.0) checks.near(row[3], std::copysign(most, moment), 1e-14, "saturated", e);
    }
  }
}

constexpr Case kMagnetCases[] = {
    {"magnets", "moments-and-distances", "of |B|",
     "1e-12 to 1e12 A m^2 at 1e-6 to 1e6 m: a root of 32 bits squared by Newton, 1e-13, and 4e-18 m over r",
     one_magnet},
    {"magnets", "at-distance-0", "of |B|",
     "at a magnet's centre and within its radius, 0, 1e5, 1e7 m away: the field at its radius", within_it},
    {"magnets", "far-fields", "of |B|",
     "200 magnets in a line 0, 1e5, 1e7 m away: differences are taken in 64 bits, 1e-13", far_origins},
    {"magnets", "cancelling-pairs", "of |B|",
     "1 000 magnets in opposite pairs: exactly 0; next to them, 1e-13 of magnitudes", cancelling_pairs},
    {"magnets", "saturation", "T",
     "1e12 A m^2 at 0 and 1e-6 m: readings stay at the sensitivity of 21.47 T, one rounding", saturated},
};

}  // namespace

std::span<const Case> magnet_cases() { return kMagnetCases; }

}  // namespace sf::selftest
