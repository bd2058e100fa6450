// Random scenes at the limits of the range compared with 50 and 100 decimal digits (Boost.Multiprecision): readings of
// lasers, magnetometers and lane edge sensors in farms.

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_bin_float.hpp>

#include "selftest/exact_ray_cast.h"
#include "selftest/fixture.h"
#include "sensors/laser_settings.h"
#include "sensors/magnetic_field/sampling.h"
#include "tests/sensors/chance.h"

namespace sf::selftest {
namespace {

using Digits50 = boost::multiprecision::cpp_bin_float_50;
using Digits100 = boost::multiprecision::cpp_bin_float_100;
using trial::Chance;

Fixture& fixture() {
  static gpu::Device device;
  static Fixture fixture(device);
  return fixture;
}

/// Uniform in the exponent.
double magnitude(Chance& chance, double low, double high) {
  return std::pow(10.0, chance.between(std::log10(low), std::log10(high)));
}

struct Met {
  Digits50 range;
  double sine = 1.0, arm = 0.0;
  bool ambiguous = false;  ///< whether a free end is so near that 64-bit rounding decides
};

/// Tests every wall, with signs and quotients in 50 digits.
Met nearest_hit(const world::World& world, const Pose& eye, const sensors::LaserSettings& laser, std::uint32_t sample) {
  Digits50 part = laser.samples < 2 ? Digits50(0) : Digits50(sample) / Digits50(laser.samples - 1) - Digits50(0.5);
  const Digits50 angle = Digits50(eye.yaw) + Digits50(laser.fov) * part;
  const Digits50 dx = cos(angle), dy = sin(angle);
  Met met{.range = laser.range_max};
  std::vector<Digits50> hairs;
  for (const world::Segment& s : world.walls) {
    const Digits50 wax = Digits50(s.a.x) - eye.x, way = Digits50(s.a.y) - eye.y;
    const Digits50 ex = Digits50(s.b.x) - s.a.x, ey = Digits50(s.b.y) - s.a.y;
    const Digits50 below = ex * dy - ey * dx;
    if (below == 0) continue;
    const Digits50 t = (ex * way - ey * wax) / below, u = (dx * way - dy * wax) / below;
    if (t < 0) continue;
    // Rounding moves a hit on a wall by 1e-14 of the lengths involved, divided by the sine.
    const double length = std::hypot(s.b.x - s.a.x, s.b.y - s.a.y);
    const double sine = static_cast<double>(abs(below)) / length;
    const double arm = std::hypot(s.a.x - eye.x, s.a.y - eye.y);
    const double slack = 1e-14 * (arm + length) / (length * sine);
    if (abs(u) < slack || abs(u - 1) < slack) hairs.push_back(t);
    if (u < 0 || u > 1 || t >= met.range) continue;
    met = {t, sine, arm};
  }
  for (const Digits50& t : hairs) met.ambiguous = met.ambiguous || t < met.range * (1 + 1e-12);
  return met;
}

/// Blocks and thin walls of 1e-3 to 10 times `size` [m] around `at`.
world::World scene(Chance& chance, glm::dvec2 at, double size) {
  world::World world;
  for (int i = 0; i < 12; ++i) {
    const glm::dvec2 p = at + size * chance.in_square(1.0);
    const double length = size * magnitude(chance, 1e-3, 10.0);
    add_wall(world, p, p + base::rotate(chance.between(-4.0, 4.0), {length, 0.0}));
  }
  return world;
}

/// Scenes of a millimetre to 100 km, up to 1e7 m away, headings to 1e6 rad. Allowed: 64-bit rounding of a direction (15
/// u) and of the products, (18 range + 4 arm) u / sine; u = 1.1e-16.
TEST(Oracle, LaserRangesInRandomScenes) {
  Chance chance(21);
  std::size_t beams = 0, met_something = 0, hairs = 0;
  double worst = 0.0;
  for (int trial = 0; trial < 150; ++trial) {
    const double size = magnitude(chance, 1e-3, 1e5), far = chance.below(3) == 0 ? 0.0 : magnitude(chance, 1.0, 1e7);
    const glm::dvec2 at = base::rotate(chance.between(-3.0, 3.0), {far, 0.0});
    world::World world = scene(chance, at, size);
    const double turn = chance.below(4) == 0 ? 1e6 : 4.0;
    const sensors::LaserSettings eye =
        laser(1 + chance.below(40), chance.between(0.0, 2.0 * M_PI), std::min(size, 1e5));
    add_laser_mover(world, {at.x, at.y, 0.0, chance.between(-turn, turn)}, eye);
    const TestFarm test = fixture().measure(world);
    for (std::uint32_t i = 0; i < eye.samples; ++i, ++beams) {
      const Met met = nearest_hit(world, test.readings[0].X_WS, eye, i);
      if (met.ambiguous) {
        ++hairs;
        continue;
      }
      const double range = test.readings[0].values[i];
      if (met.range == eye.range_max) {
        EXPECT_EQ(range, eye.range_max) << "trial " << trial << " beam " << i;
        continue;
      }
      ++met_something;
      const double allowed = 2e-15 * (met.arm + static_cast<double>(met.range)) / met.sine;
      const double error = std::abs(static_cast<double>(Digits50(range) - met.range));
      worst = std::max(worst, error / allowed);
      EXPECT_LE(error, allowed) << "trial " << trial << " beam " << i << " of " << size << " m";
    }
  }
  std::printf("[ measured ] %zu beams, %zu met something, %zu by a hair, worst %.2g of what is allowed\n", beams,
              met_something, hairs, worst);
  EXPECT_GT(met_something, 1000u);
  EXPECT_LT(hairs, beams / 50);
}

/// Moments of 1e-12 to 1e12, distances of 1e-6 to 1e6 m, above and below. Allowed: 1e-13 of the sum of magnitudes (a
/// 32-bit root improved by Newton's step), and 4e-18 m over the distance for the height that avoids a division by zero
/// at a magnet's centre.
TEST(Oracle, FieldsOfRandomMagnets) {
  Chance chance(22);
  double worst = 0.0;
  for (int trial = 0; trial < 60; ++trial) {
    const double far = chance.below(2) == 0 ? 0.0 : 1e7;
    world::World world;
    for (std::uint32_t i = 0; i < 1 + chance.below(30); ++i) {
      const glm::dvec2 p = magnitude(chance, 1e-6, 1e6) * chance.in_square(1.0);
      const double sign = chance.below(2) == 0 ? -1.0 : 1.0;
      // The device's moment has 32 bits.
      const auto moment = static_cast<float>(sign * magnitude(chance, 1e-12, 1e12));
      world.magnets.push_back({{far + p.x, p.y}, chance.between(-1e-3, 1e-3), moment, 1e-9, 0});
    }
    const sensors::FieldPoint place{far, 0.0, chance.between(-1e-2, 1e-2)};
    Digits100 x = 0, y = 0, z = 0, magnitudes = 0;
    double nearest = HUGE_VAL;
    for (const world::Magnet& m : world.magnets) {
      const Digits100 dx = Digits100(place.x) - m.p.x, dy = Digits100(place.y) - m.p.y, dz = Digits100(place.z) - m.z;
      const Digits100 r2 = dx * dx + dy * dy + dz * dz;
      const Digits100 k = Digits100(1e-7) * m.moment / (r2 * r2 * sqrt(r2));
      const Digits100 bx = 3 * k * dx * dz, by = 3 * k * dy * dz, bz = k * (2 * dz * dz - dx * dx - dy * dy);
      x += bx, y += by, z += bz;
      magnitudes += sqrt(bx * bx + by * by + bz * bz);
      nearest = std::min(nearest, static_cast<double>(sqrt(r2)));
    }
    const auto sum = sensors::sample_field(world, fixture().device(), {&place, 1}, {.magnitudes = true})[0];
    const Digits100 ex = sum.x - x, ey = sum.y - y, ez = sum.z - z;
    const auto apart = static_cast<double>(sqrt(ex * ex + ey * ey + ez * ez) / magnitudes);
    const double allowed = 1e-13 + 4e-18 / nearest;
    worst = std::max(worst, apart / allowed);
    EXPECT_LE(apart, allowed) << "trial " << trial;
    EXPECT_LE(std::abs(static_cast<double>(sum.magnitudes / magnitudes - 1)), allowed) << "trial " << trial;
  }
  std::printf("[ measured ] fields: worst %.2g of what is allowed\n", worst);
}

/// Straight markings at any heading and tilt, 1e-5 to 1e3 m away, up to 1e7 m from the origin. Allowed: four roundings
/// of the marking's corners, and 1e-13 of the distance for a pixel size stored in a point's last bits, over cos^2 of
/// the tilt.
TEST(Oracle, DistancesToRandomEdges) {
  Chance chance(23);
  double worst = 0.0;
  int seen = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const double far = chance.below(2) == 0 ? 0.0 : magnitude(chance, 1.0, 1e7);
    const double grain = std::nextafter(2.0 * far, HUGE_VAL) - 2.0 * far;
    // Nearer than a few thousand grains, rounding bends the marking.
    const double distance = magnitude(chance, std::max(1e-5, 1e4 * grain), 1e3);
    const double tilt = chance.between(-1.2, 1.2), yaw = chance.between(-4.0, 4.0);
    const Pose X{far, -far, 0.0, yaw};
    const glm::dvec2 normal = base::rotate(yaw + tilt, {1.0, 0.0}), along{-normal.y, normal.x};
    const glm::dvec2 middle =
        glm::dvec2{X.x, X.y} + distance * base::rotate(yaw, {1.0, 0.0}) + 0.05 * distance * normal;
    world::World world;
    world.lane_markings.push_back({{middle - 5.0 * distance * along, middle + 5.0 * distance * along}, 0.1 * distance});
    world.movers[add_mover(world, X)].sensors.push_back(
        sensor("laneedge", {{"perpendicular", {0.0}}, {"range_max", {3.0 * distance}}}, 0.1));
    const TestFarm test = fixture().measure(world);
    const glm::dvec2 a = world.lane_markings[0].line[0], b = world.lane_markings[0].line[1];
    const Digits50 tx = Digits50(b.x) - a.x, ty = Digits50(b.y) - a.y, size = sqrt(tx * tx + ty * ty);
    const Digits50 nx = ty / size, ny = -tx / size;
    const Digits50 height =
        nx * (Digits50(a.x) - X.x) + ny * (Digits50(a.y) - X.y) - Digits50(world.lane_markings[0].width) / 2;
    const Digits50 exact = height / (nx * cos(Digits50(yaw)) + ny * sin(Digits50(yaw)));
    const double got = test.readings[0].values[0];
    const double allowed = (4.0 * grain + 1e-13 * distance) / std::pow(std::cos(tilt), 2);
    const double error = std::abs(static_cast<double>(Digits50(got) - exact));
    seen += std::isfinite(got);
    worst = std::max(worst, error / allowed);
    EXPECT_LE(error, allowed) << "trial " << trial << ": " << distance << " m ahead, tilt " << tilt << ", " << far
                              << " m away, got " << got;
  }
  std::printf("[ measured ] edges: worst %.2g of what is allowed\n", worst);
  EXPECT_EQ(seen, 40);
}

/// A beam at every heading to a corner 2 m ahead. At a free end, and between walls on one side of the beam, there is a
/// gap of any width, so rounding decides. Walls on both sides leave no gap.
TEST(ExactRayCast, OnlyClosedCornersAreUnambiguous) {
  for (int k = 0; k < 64; ++k) {
    const double heading = 0.1 * k - 3.15;
    const Pose X{3.0, -7.0, 0.0, heading};
    const auto at = [&](double ahead, double left) { return base::transform(X, glm::dvec2{ahead, left}); };
    const glm::dvec2 corner = at(2.0, 0.0), far_left = at(4.0, 1.0), left = at(2.5, 1.5), right = at(3.0, -1.0);
    const Beam beam = beam_of(X, laser(1, 0.0, 8.0), 0);
    const auto hit = [&](const std::vector<std::pair<glm::dvec2, glm::dvec2>>& walls) {
      world::World world;
      for (const auto& [a, b] : walls) add_wall(world, a, b);
      return nearest_hit(world.walls, beam, 8.0);
    };
    EXPECT_TRUE(hit({{corner, left}}).ambiguous) << "a free end at heading " << heading;
    EXPECT_TRUE(hit({{corner, left}, {far_left, corner}}).ambiguous) << "both on the left at heading " << heading;
    EXPECT_TRUE(hit({{corner, left}, {at(2.0, 1e-3), right}}).ambiguous) << "not at one point";
    for (const bool turned : {false, true}) {
      const Hit closed = hit({{corner, left}, turned ? std::pair{right, corner} : std::pair{corner, right}});
      EXPECT_FALSE(closed.ambiguous) << "closed at heading " << heading;
    }
    EXPECT_FALSE(hit({{at(1.0, -1.0), at(1.0, 1.0)}, {corner, left}}).ambiguous) << "behind a wall";
    EXPECT_FALSE(hit({{at(2.0, 1e-9), left}}).ambiguous) << "farther off than rounding";
  }
}

/// The reference detects a wall that is displaced by more than rounding.
TEST(Oracle, DetectsADisplacedWall) {
  world::World world;
  add_wall(world, {2.0, -1.0}, {2.5, 1.0});
  const sensors::LaserSettings eye = laser(1, 0.0, 8.0);
  add_laser_mover(world, {0.0, 0.0, 0.0, 0.1}, eye);
  const TestFarm test = fixture().measure(world);
  const Met there = nearest_hit(world, test.readings[0].X_WS, eye, 0);
  EXPECT_LE(abs(Digits50(test.readings[0].values[0]) - there.range), 2e-14);
  world.walls[0].a.x += 1e-12;
  EXPECT_GT(abs(Digits50(test.readings[0].values[0]) - nearest_hit(world, test.readings[0].X_WS, eye, 0).range), 2e-13);
}

/// A wall 2 m ahead of five beams: the outer two hit nothing within 8 m.
world::World wall_ahead() {
  world::World world;
  add_wall(world, {2.0, -3.0}, {2.0, 3.0});
  add_laser_mover(world, {}, laser(5, 2.0, 8.0));
  return world;
}

Outcome judged(const TestFarm& test, std::span<const double> values, std::uint32_t stride = 1) {
  base::ReadingBlock reading = test.readings[0];
  reading.values = values;
  Checks checks;
  check_scan(test, reading, checks, "scan", stride);
  return checks.outcome();
}

TEST(CheckScan, RejectsEachWrongBeam) {
  const TestFarm test = fixture().measure(wall_ahead());
  const std::vector<double> good(test.readings[0].values.begin(), test.readings[0].values.end());
  EXPECT_TRUE(judged(test, good).passed());
  EXPECT_EQ(judged(test, good).checks, 6u) << "five beams and their number";
  for (std::size_t i = 0; i < good.size(); ++i)
    for (const double wrong : {good[i] * (1.0 + 1e-13), good[i] * (1.0 - 1e-13), kNan}) {
      std::vector<double> values = good;
      values[i] = wrong;
      const Outcome o = judged(test, values);
      EXPECT_EQ(o.failed, 1u) << wrong;
      EXPECT_EQ(o.failure.find(fmt::format("scan [{}]: {:.17g}, expected ", i, wrong)), 0u) << o.failure;
    }
}

TEST(CheckScan, ABeamWithoutAReturnEqualsItsRangeBitwise) {
  const TestFarm test = fixture().measure(wall_ahead());
  std::vector<double> values(test.readings[0].values.begin(), test.readings[0].values.end());
  values[4] = std::nextafter(8.0, 0.0);
  EXPECT_EQ(judged(test, values).failure, "scan [4]: 7.9999999999999991, expected 8");
}

TEST(CheckScan, RejectsAWrongNumberOfBeams) {
  const TestFarm test = fixture().measure(wall_ahead());
  EXPECT_EQ(judged(test, test.readings[0].values.first(4)).failure, "scan: samples: 4, expected 5 [0]");
}

TEST(CheckScan, AStrideSkipsBeams) {
  const TestFarm test = fixture().measure(wall_ahead());
  std::vector<double> values(test.readings[0].values.begin(), test.readings[0].values.end());
  values[1] = values[3] = kNan;
  EXPECT_TRUE(judged(test, values, 2).passed());
  EXPECT_EQ(judged(test, values, 2).checks, 4u);
  values[4] = kNan;
  EXPECT_EQ(judged(test, values, 2).failed, 1u);
}

/// The middle beam passes the free end of a wall.
TEST(CheckScan, AmbiguousBeamsAreOnlyNoted) {
  world::World world = wall_ahead();
  world.walls[0].a.y = 0.0;
  const TestFarm test = fixture().measure(world);
  std::vector<double> values(test.readings[0].values.begin(), test.readings[0].values.end());
  values[2] = kNan;
  const Outcome o = judged(test, values);
  EXPECT_TRUE(o.passed()) << o.failure;
  EXPECT_EQ(o.checks, 5u);
  EXPECT_EQ(o.notes, std::vector<std::string>{"scan: 1 beams pass an end within rounding and were not judged"});
}

/// Computed by hand for a wall that is 3 m away and hit 4 m ahead at a sine of 0.5.
TEST(ExactRayCast, TheBoundGrowsWithDistancesAndShrinksWithTheSine) {
  EXPECT_NEAR(rounding({.range = 4, .model = 0, .sine = 0.5, .arm = 3}), 2.8e-14, 1e-28);
}

}  // namespace
}  // namespace sf::selftest
