// Worlds from 1 mm to 1 000 km, near the origin and far away; ranges from 1 um to 100 km.

#include <fmt/format.h>

#include "selftest/exact_ray_cast.h"
#include "selftest/fixture.h"
#include "selftest/suite.h"

namespace sf::selftest {

namespace {

constexpr double kFar[] = {0.0, 1e5, 1e7};           ///< [m] offset from the origin, along both axes
constexpr double kWidths[] = {1e-3, 1.0, 1e3, 1e6};  ///< [m]

/// A square room and a laser inside it that sees all of its walls.
void check_full_turn(Fixture& fixture, Checks& checks, double far, double width, std::uint32_t samples) {
  world::World world;
  add_room(world, {far - 0.4 * width, far - 0.3 * width}, width);
  add_laser_mover(world, {far + 0.137 * width, far - 0.0211 * width, 0.0, 0.3}, laser(samples, kTurn, 2.0 * width));
  const TestFarm test = fixture.measure(world);
  check_scan(test, test.readings[0], checks, fmt::format("{:g} m wide, {:g} m away", width, far));
}

void widths(Fixture& fixture, Checks& checks) {
  for (const double width : kWidths) check_full_turn(fixture, checks, 0.0, width, 361);
}

void distances(Fixture& fixture, Checks& checks) {
  for (const double far : kFar)
    for (const double width : kWidths) check_full_turn(fixture, checks, far, width, 61);
}

/// Corners, lasers and shifts on a lattice of 2^-20 m: sums are exact, so ranges are bitwise equal.
void moved(Fixture& fixture, Checks& checks) {
  std::vector<std::vector<double>> scans;
  for (const double far : kFar) {
    world::World world;
    add_room(world, {far - 3.0, far - 2.5}, 6.0);
    add_block(world, {far + 0.5 + 0x1p-20, far + 0.25}, {far + 1.5, far + 1.0 - 0x1p-19});
    add_laser_mover(world, {far - 1.25, far - 0.5 + 0x1p-20, 0.0, 1.0}, laser(361, kTurn, 8.0));
    const TestFarm test = fixture.measure(world);
    scans.emplace_back(test.readings[0].values.begin(), test.readings[0].values.end());
  }
  for (std::size_t f = 1; f < scans.size(); ++f)
    for (std::size_t i = 0; i < scans[0].size(); ++i)
      checks.same(scans[f][i], scans[0][i], fmt::format("{:g} m away", kFar[f]), i);
}

/// A wall at `distance` in front of a laser with range `range`.
double straight(Fixture& fixture, double range, double distance, double across) {
  world::World world;
  add_wall(world, {distance, -across}, {distance, across});
  add_laser_mover(world, {}, laser(1, 0.0, range));
  return fixture.measure(world).readings[0].values[0];
}

void ranges(Fixture& fixture, Checks& checks) {
  for (const double range : {1e-6, 1e-3, 1.0, 1e3, 1e5}) {
    const auto what = fmt::format("range {:g} m", range);
    checks.same(straight(fixture, range, 0.5 * range, range), 0.5 * range, what + ", a wall half way");
    checks.same(straight(fixture, range, 0.999 * range, range), 0.999 * range, what + ", a wall just within");
    checks.same(straight(fixture, range, range, range), range, what + ", a wall at its end");
    checks.same(straight(fixture, range, 1.001 * range, range), range, what + ", a wall just beyond");
    checks.same(straight(fixture, range, 0.7 * range, 1e6), 0.7 * range, what + ", a wall of 2 000 km");
  }
}

/// From the middle of a world of 1 000 km with a range of 100 km: towers 10 m wide at 99.9 km.
void far_and_small(Fixture& fixture, Checks& checks) {
  world::World world;
  add_room(world, {-5e5, -5e5}, 1e6);
  constexpr double kAway = 99'900.0;
  for (int i = 0; i < 16; ++i) {
    const glm::dvec2 p = base::rotate(i * kTurn / 16, {kAway, 0.0});
    add_block(world, p - glm::dvec2{5.0, 5.0}, p + glm::dvec2{5.0, 5.0});
    add_laser_mover(world, {0.0, 0.0, 0.0, i * kTurn / 16}, laser(5, 1e-5, 1e5));
  }
  const TestFarm test = fixture.measure(world);
  for (const base::ReadingBlock& reading : test.readings) {
    checks.holds(reading.values[2] < 1e5, "the tower is seen", reading.mover);
    check_scan(test, reading, checks, "towers");
  }
}

/// The smallest and largest values of a pose.
void poses(Fixture& fixture, Checks& checks) {
  constexpr double kDenormal = std::numeric_limits<double>::denorm_min();
  for (const double x : {kDenormal, -kDenormal, 1e-310, std::numeric_limits<double>::min(), 1e7, -1e7})
    for (const double yaw : {0.0, kDenormal, -1e-310}) {
      world::World world;
      add_wall(world, {x + 2.0, -1.0}, {x + 2.0, 1.0});
      add_laser_mover(world, {}, laser(1, 0.0, 8.0));
      TestFarm test = fixture.measure(world);
      const base::Report report{.mover = 0, .X_WM = {x, kDenormal, 0.0, yaw}};
      const auto readings = test.farm->tick(1'000'000'000, {&report, 1});
      checks.same(readings[0].values[0], 2.0, fmt::format("x {:g}, yaw {:g}", x, yaw));
    }
}

constexpr Case kWorldSizeCases[] = {
    {"places", "world-widths", "m", "rooms 1 mm to 1 000 km wide: exact walls, within rounding of 64 bits", widths},
    {"places", "far-origins", "m", "rooms of all widths 0, 1e5 and 1e7 m away: the walls as doubles have them",
     distances},
    {"places", "moved-worlds", "m", "a world on a lattice moved by 1e5 and 1e7 m: sums are exact, so no bit changes",
     moved},
    {"places", "ranges", "m", "1 um to 100 km, straight at a wall: products with 0 and 1 are exact, so no bit is off",
     ranges},
    {"places", "far-and-small", "m", "towers of 10 m at 99.9 km in 1 000 km: within rounding of 64 bits",
     far_and_small},
    {"numbers", "in-poses", "m", "denormal and largest poses: sums are exact, so no bit is off", poses},
};

}  // namespace

std::span<const Case> world_size_cases() { return kWorldSizeCases; }

}  // namespace sf::selftest
