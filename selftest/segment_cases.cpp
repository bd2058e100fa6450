// Walls of zero length, slivers, and a million walls in one cell.

#include <fmt/format.h>

#include "selftest/exact_ray_cast.h"
#include "selftest/fixture.h"
#include "selftest/suite.h"

namespace sf::selftest {

namespace {

/// A wall of zero length among others, added without the reader: it is never hit and hides nothing.
void zero_length(Fixture& fixture, Checks& checks) {
  world::World world;
  add_room(world, {-2.0, -2.0}, 4.0);
  for (const glm::dvec2& p : {glm::dvec2{1.0, 0.0}, glm::dvec2{0.0, 0.0}, glm::dvec2{2.0, 0.0}, glm::dvec2{-2.0, -2.0}})
    add_wall(world, p, p);
  add_laser_mover(world, {0.0, 0.0, 0.0, 0.0}, laser(361, kTurn, 8.0));
  const TestFarm test = fixture.measure(world);
  check_scan(test, test.readings[0], checks, "walls without length");
  checks.same(test.readings[0].values[180], 2.0, "straight through them");
}

/// Blocks 1 m long and down to 1e-12 m thin, seen from their sides and from their ends.
void slivers(Fixture& fixture, Checks& checks) {
  for (const double thick : {1e-3, 1e-6, 1e-9, 1e-12})
    for (const double far : {0.0, 1e5}) {
      // Far away doubles are 1.5e-11 m apart, so thinner blocks collapse.
      if (far + 1.0 + thick == far + 1.0) continue;
      world::World world;
      add_block(world, {far + 1.0, far - 0.5}, {far + 1.0 + thick, far + 0.5});
      add_outline(world, {{far - 1.0, far - 0.5}, {far - 1.0, far + 0.5}, {far - 1.0 - thick, far}});
      for (const double yaw : {0.0, 0.3, M_PI, 2.9}) add_laser_mover(world, {far, far, 0.0, yaw}, laser(31, 0.4, 8.0));
      add_laser_mover(world, {far + 1.0 + 0.5 * thick, far - 2.0, 0.0, 0.5 * M_PI}, laser(1, 0.0, 8.0));
      const TestFarm test = fixture.measure(world);
      for (const base::ReadingBlock& r : test.readings)
        check_scan(test, r, checks, fmt::format("{:g} m thick, {:g} m away", thick, far));
    }
}

/// Walls of nanometres next to walls of 200 km.
void tiny_beside_huge(Fixture& fixture, Checks& checks) {
  world::World world;
  add_wall(world, {-1e5, 3.0}, {1e5, 3.5});
  add_wall(world, {4.0, -1e5}, {4.5, 1e5});
  for (int i = 0; i < 40; ++i) {
    const glm::dvec2 p = base::rotate(0.151 * i, {1.0 + 0.04 * i, 0.0});
    add_wall(world, p, p + glm::dvec2{1e-9 * (1 + i), -2e-9});
    add_laser_mover(world, {0.0, 0.0, 0.0, std::atan2(p.y - 1e-9, p.x + 0.5e-9 * (1 + i))}, laser(3, 1e-10, 8.0));
  }
  add_laser_mover(world, {0.0, 0.0, 0.0, 0.0}, laser(361, kTurn, 8.0));
  const TestFarm test = fixture.measure(world);
  for (const base::ReadingBlock& r : test.readings) check_scan(test, r, checks, "nanometres next to 200 km");
}

/// `side` x `side` posts of four walls each on a square metre.
world::World posts(std::uint32_t side) {
  world::World world;
  world.models.push_back({"posts", "model"});
  world.walls.reserve(4 * std::size_t{side} * side);
  const double pitch = 1.0 / side;
  for (std::uint32_t x = 0; x < side; ++x)
    for (std::uint32_t y = 0; y < side; ++y) {
      const glm::dvec2 low{x * pitch, y * pitch}, high{(x + 0.5) * pitch, (y + 0.5) * pitch};
      const glm::dvec2 corners[] = {low, {high.x, low.y}, high, {low.x, high.y}};
      for (std::size_t i = 0; i < 4; ++i) {
        world::Segment s;
        s.a = corners[i];
        s.b = corners[(i + 1) % 4];
        s.z_max = 1.0;
        world.walls.push_back(s);
      }
    }
  return world;
}

/// The cells of a laser with few beams are larger than the square, so all walls are in one cell.
void a_million(Fixture& fixture, Checks& checks) {
  constexpr std::uint32_t kSide = 500;
  world::World world = posts(kSide);
  checks.equal(world.walls.size(), 1'000'000u, "walls");
  const double between = (250.0 + 0.75) / kSide;  // four posts
  add_laser_mover(world, {between, between, 0.0, 0.0}, laser(17, kTurn, 0.1));
  const TestFarm test = fixture.measure(std::move(world));
  check_scan(test, test.readings[0], checks, "between a million walls");
  checks.same(test.readings[0].values[8], 0.1, "along the lane between them");
  world::World fewer = posts(kSide / 2);
  add_laser_mover(fewer, {-1.0, 0.5, 0.0, 0.0}, laser(16, 0.1, 8.0));
  const TestFarm longest = fixture.measure(std::move(fewer));
  check_scan(longest, longest.readings[0], checks, "a quarter of a million in one direction of one cell");
}

constexpr Case kSegmentCases[] = {
    {"segments", "zero-length", "m", "walls of zero length are never hit: the others, within rounding", zero_length},
    {"segments", "slivers", "m", "blocks 1 mm to 1e-12 m thick: their faces, within rounding", slivers},
    {"segments", "tiny-beside-huge", "m", "walls of nanometres next to walls of 200 km, aimed at: within rounding",
     tiny_beside_huge},
    {"segments", "a-million-in-one-cell", "m",
     "a million walls on a square metre: exact, on the device or, beyond its lists, on the host", a_million},
};

}  // namespace

std::span<const Case> segment_cases() { return kSegmentCases; }

}  // namespace sf::selftest
