// Numbers of samples, fields of view and headings.

#include <fmt/format.h>

#include "selftest/exact_ray_cast.h"
#include "selftest/fixture.h"
#include "selftest/suite.h"

namespace sf::selftest {

namespace {

world::World room_with_blocks() {
  world::World world;
  add_room(world, {-5.0, -4.0}, 9.0);
  add_block(world, {1.0, 1.0}, {1.5, 3.0});
  add_outline(world, {{-2.0, -1.0}, {-1.0, -2.5}, {-1.5, -0.5}});
  return world;
}

void check_scans(Fixture& fixture, Checks& checks, std::span<const std::uint32_t> samples, std::uint32_t stride) {
  world::World world = room_with_blocks();
  for (const std::uint32_t count : samples)
    for (const double fov : {0.0, 1e-6, 1.0, 90.0, 180.0, 270.0, 360.0})
      add_laser_mover(world, {0.21, -0.13, 0.0, 0.5}, laser(count, fov * kDegree, 20.0));
  const TestFarm test = fixture.measure(world);
  for (const base::ReadingBlock& r : test.readings) {
    const sensors::LaserSettings& laser = laser_of(test, r);
    const auto what = fmt::format("{} samples in {:g} degrees", laser.samples, laser.fov / kDegree);
    check_scan(test, r, checks, what, stride);
    if (laser.fov == 0.0)
      for (const double range : r.values) checks.same(range, r.values[0], what + ": all beams are one");
  }
}

void few_and_many(Fixture& fixture, Checks& checks) {
  constexpr std::uint32_t kCounts[] = {1, 2, 3, 4, 5, 7, 8, 9, 31, 64, 361, 1001};
  check_scans(fixture, checks, kCounts, 1);
}

void a_hundred_thousand_samples(Fixture& fixture, Checks& checks) {
  constexpr std::uint32_t kCounts[] = {100'000};
  check_scans(fixture, checks, kCounts, 7);
}

/// A full turn: the first and the last beam point backwards along the same line.
void whole_turn(Fixture& fixture, Checks& checks) {
  world::World world = room_with_blocks();
  for (const std::uint32_t count : {2u, 3u, 361u, 100'000u})
    add_laser_mover(world, {0.21, -0.13, 0.0, 0.0}, laser(count, 2.0 * M_PI, 20.0));
  const TestFarm test = fixture.measure(world);
  for (const base::ReadingBlock& r : test.readings)
    checks.near(r.values.front(), static_cast<Real>(r.values.back()), 2e-15 * (5.21 + 5.0), "first and last", r.mover);
}

/// The same heading plus many turns: the reference uses the cosine of the rounded double.
void headings(Fixture& fixture, Checks& checks) {
  world::World world = room_with_blocks();
  for (const double yaw : {0.0, -0.0, 0.5 * M_PI, M_PI, -M_PI, 100.0, -1234.5, 1e6, -1e6, 999'999.9, 1e-300, 5e-324})
    add_laser_mover(world, {0.21, -0.13, 0.0, yaw}, laser(61, 2.0, 20.0));
  const TestFarm test = fixture.measure(world);
  for (const base::ReadingBlock& r : test.readings)
    check_scan(test, r, checks, fmt::format("heading {:g}", r.X_WS.yaw));
}

constexpr Case kScanCases[] = {
    {"fans", "samples-and-widths", "m", "1 to 1 001 samples in 0, 1e-6 to 360 degrees: every beam within rounding",
     few_and_many},
    {"fans", "a-hundred-thousand-samples", "m",
     "100 000 samples in 0, 1e-6 to 360 degrees: every 7th beam within rounding", a_hundred_thousand_samples},
    {"fans", "whole-turn", "m", "360 degrees: the first and the last beam coincide, within rounding", whole_turn},
    {"fans", "headings", "m",
     "headings to 1e6 rad, 0 of both signs and denormal, as rounded to double: within rounding", headings},
};

}  // namespace

std::span<const Case> scan_cases() { return kScanCases; }

}  // namespace sf::selftest
