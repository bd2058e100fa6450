// No range exceeds the bound of its reading: a million random beams in each of ten worlds, in 64 and in 32 bits,
// compared with `long double`.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/thread_pool.h"
#include "raycast/casters.h"
#include "sensors/accuracy.h"
#include "sensors/laser_settings.h"
#include "tests/instrumented.h"
#include "tests/sensors/brute_force.h"
#include "tests/sensors/chance.h"
#include "tests/sensors/compare.h"
#include "tests/sensors/scenes.h"

namespace sf::trial {
namespace {

using Wide = long double;

const int kTicks = instrumented() ? 1 : 28;
constexpr std::uint32_t kBoundRobots = 100;  // with 361 beams each

/// A world with the square in which robots are placed.
struct BoundScene {
  world::World world;
  glm::dvec2 middle;
  double half = 1.0;  ///< [m] half the side of that square
};

struct BoundTally {
  std::size_t beams = 0, flagged = 0, beyond = 0;
  double worst = 0.0;        ///< [m] of beams without a flag
  double worst_share = 0.0;  ///< as a fraction of the bound
  double flagged_worst = 0.0;
  double bound = 0.0;
  std::string example;
};

/// Segments by their end points, relative to the sensor, with as few divisions as possible.
Wide cast(std::span<const world::Segment> surfaces, glm::dvec2 o, Wide direction, Wide range_max) {
  const Wide dx = std::cos(direction), dy = std::sin(direction);
  Wide best = range_max;
  for (const world::Segment& s : surfaces) {
    const Wide ax = static_cast<Wide>(s.a.x) - o.x, ay = static_cast<Wide>(s.a.y) - o.y;
    const Wide bx = static_cast<Wide>(s.b.x) - o.x, by = static_cast<Wide>(s.b.y) - o.y;
    const Wide side_a = dx * ay - dy * ax, side_b = dx * by - dy * bx;
    if ((side_a > 0 && side_b > 0) || (side_a < 0 && side_b < 0)) continue;
    const Wide ex = bx - ax, ey = by - ay;
    const Wide below = ex * dy - ey * dx;
    if (below == 0) continue;
    const Wide t = (ex * ay - ey * ax) / below;
    if (t >= 0 && t < best) best = t;
  }
  return best;
}

void look(const BoundScene& scene, std::span<const base::Pose> poses, const base::ReadingBlock& reading,
          BoundTally& seen) {
  const sensors::LaserSettings laser = sensors::lasers_of(scene.world.movers[reading.mover])[0];
  const auto all = oracle::surfaces(scene.world, poses, reading.mover, reading.X_WS.z);
  const auto near = oracle::within(all, {reading.X_WS.x, reading.X_WS.y}, laser.range_max);
  seen.bound = std::max(seen.bound, reading.bound);
  for (std::uint32_t i = 0; i < laser.samples; ++i) {
    const Wide direction = static_cast<Wide>(reading.X_WS.yaw) + bearing_of(laser, i);
    const Wide truth = cast(near, {reading.X_WS.x, reading.X_WS.y}, direction, laser.range_max);
    const double error = std::abs(static_cast<double>(reading.values[i] - truth));
    ++seen.beams;
    if (!reading.quality.empty() && reading.quality[i] != base::QualityFlag::none) {
      ++seen.flagged;
      seen.flagged_worst = std::max(seen.flagged_worst, error);
      continue;
    }
    seen.worst = std::max(seen.worst, error);
    seen.worst_share = std::max(seen.worst_share, error / reading.bound);
    if (error <= reading.bound) continue;
    if (seen.beyond++ == 0)
      seen.example = fmt::format("mover {} beam {}: {} instead of {}, bound {}", reading.mover, i, reading.values[i],
                                 static_cast<double>(truth), reading.bound);
  }
}

void add(const BoundTally& part, BoundTally& sum) {
  sum.beams += part.beams;
  sum.flagged += part.flagged;
  sum.beyond += part.beyond;
  sum.worst = std::max(sum.worst, part.worst);
  sum.worst_share = std::max(sum.worst_share, part.worst_share);
  sum.flagged_worst = std::max(sum.flagged_worst, part.flagged_worst);
  sum.bound = std::max(sum.bound, part.bound);
  if (sum.example.empty()) sum.example = part.example;
}

BoundTally measure(BoundScene& scene, const std::string& mode, const raycast::CasterType* caster, int ticks) {
  sensors::set_accuracy(scene.world, mode);
  farm::Farm farm(scene.world, device(), {.scene = {.caster = caster}});
  farm.subscribe_all();
  base::ThreadPool thread_pool(0);
  Chance chance(11);
  BoundTally sum;
  for (int tick = 0; tick < ticks; ++tick) {
    std::vector<base::Pose> poses;
    std::vector<base::Report> reports;
    for (std::uint32_t m = 0; m < scene.world.movers.size(); ++m) {
      const glm::dvec2 p = scene.middle + chance.in_square(scene.half);
      poses.push_back({p.x, p.y, 0.0, chance.between(-M_PI, M_PI)});
      reports.push_back({m, 0, poses.back(), {}});
    }
    const auto readings = farm.tick(tick * 1'000'000'000ll, reports);
    std::vector<BoundTally> parts(readings.size());
    thread_pool.parallel_for(readings.size(), 1, [&](std::size_t first, std::size_t last, unsigned) {
      for (std::size_t i = first; i < last; ++i) look(scene, poses, readings[i], parts[i]);
    });
    for (const BoundTally& part : parts) add(part, sum);
  }
  return sum;
}

BoundScene with_robots(world::World world, double half, double range, glm::dvec2 middle = {}) {
  for (std::uint32_t i = 0; i < kBoundRobots; ++i)
    scenes::add_robot(world, {middle.x, middle.y, 0.0, 0.0}, scenes::laser(361, M_PI, range));
  world::update_extent_and_hash(world);
  return {std::move(world), middle, half};
}

/// Robots without bodies: only walls are visible.
BoundScene with_eyes(world::World world, double half, double range, glm::dvec2 middle = {}) {
  for (std::uint32_t i = 0; i < kBoundRobots; ++i)
    add_eye(world, {middle.x, middle.y, 0.0, 0.0}, eye(361, 2.0 * M_PI, range));
  world::update_extent_and_hash(world);
  return {std::move(world), middle, half};
}

world::World moved(world::World world, double by) {
  world::translate(world, by, -by);
  return world;
}

/// Walls of 1000 km, two metres apart.
world::World corridor() {
  world::World world;
  scenes::add_outline(world, {{-5e5, -1.5}, {5e5, -1.5}, {5e5, -1.0}, {-5e5, -1.0}}, "south");
  scenes::add_outline(world, {{-5e5, 1.0}, {5e5, 1.0}, {5e5, 1.5}, {-5e5, 1.5}}, "north");
  return world;
}

/// Triangles `length` [m] long and a thousandth as wide, at any angle.
world::World slivers(double length, double half) {
  world::World world;
  Chance chance(5);
  for (int i = 0; i < 200; ++i) {
    const glm::dvec2 p = chance.in_square(half);
    const glm::dvec2 along = base::rotate(chance.between(-M_PI, M_PI), {length, 0.0});
    scenes::add_outline(world, {p, p + along, p + 0.5 * along + 1e-3 * base::rotate(0.5 * M_PI, along)}, "sliver");
  }
  return world;
}

/// Squares of a centimetre.
world::World forest(double half) {
  world::World world;
  Chance chance(6);
  for (int i = 0; i < 150; ++i) {
    const glm::dvec2 p = chance.in_square(half);
    const double turn = chance.between(0.0, M_PI);
    std::vector<glm::dvec2> corners;
    for (int k = 0; k < 4; ++k) corners.push_back(p + base::rotate(turn + 0.5 * M_PI * k, {0.005, 0.0}));
    scenes::add_outline(world, corners, "stem");
  }
  return world;
}

/// Thin walls that cross each other and belong to no solid.
world::World crossing(double half) {
  world::World world = slivers(1.0, half);
  for (world::Segment& wall : world.walls) wall.solid_left = false;
  return world;
}

/// Returns the world scaled by `by`.
world::World shrunk(world::World world, double by) {
  for (world::Segment& wall : world.walls) wall.a = by * wall.a, wall.b = by * wall.b;
  return world;
}

struct BoundCase {
  const char* name;
  BoundScene (*make)();
  bool exact_truth = true;  ///< otherwise the truth's outlines are less exact than the reference
};

const BoundCase kBoundCases[] = {
    {"AmongBoxes", [] { return with_robots(scenes::boxes(60, 16.0, 1), 8.0, 2.0); }},
    {"InACave", [] { return with_robots(scenes::cave(100, 16.0, 3), 8.0, 1.0); }},
    {"BetweenWallsOf1000Km", [] { return with_robots(corridor(), 1.4, 8.0); }},
    {"At100Km",
     [] {
       return with_robots(moved(scenes::boxes(40, 10.0, 2), 1e5), 5.0, 2.0, {1e5, -1e5});
     },
     false},
    {"At10000Km",
     [] {
       return with_robots(moved(scenes::boxes(40, 10.0, 2), 1e7), 5.0, 2.0, {1e7, -1e7});
     },
     false},
    {"InAMillimetre", [] { return with_eyes(shrunk(scenes::boxes(40, 10.0, 4), 1e-4), 5e-4, 2e-4); }, false},
    {"AmongSlivers", [] { return with_robots(slivers(1.0, 8.0), 8.0, 2.0); }},
    {"InAForestOfCentimetres", [] { return with_eyes(forest(3.0), 3.0, 2.0); }},
    {"AmongThinWallsThatCross", [] { return with_robots(crossing(6.0), 6.0, 2.0); }},
    {"AmongRobotsOnly", [] { return with_robots({}, 3.0, 2.0); }},
};

void expect_within_bounds(const BoundCase& c, const char* mode, const raycast::CasterType* caster = nullptr,
                          int ticks = kTicks) {
  BoundScene scene = c.make();
  const BoundTally s = measure(scene, mode, caster, ticks);
  std::printf(
      "[ measured ] %s, %s: %zu beams, worst %.2g m, %.3g of the bound (up to %.2g m); %zu flagged, worst %.2g m\n",
      c.name, mode, s.beams, s.worst, s.worst_share, s.bound, s.flagged, s.flagged_worst);
  EXPECT_EQ(s.beyond, 0u) << c.name << ", " << mode << ": " << s.example;
  EXPECT_LT(static_cast<double>(s.flagged), 0.01 * static_cast<double>(s.beams)) << c.name;
  EXPECT_GE(s.beams, ticks > 1 ? 1'000'000u : 30'000u);
}

class LaserBounds : public testing::TestWithParam<std::tuple<const char*, BoundCase>> {};

TEST_P(LaserBounds, Hold) { expect_within_bounds(std::get<1>(GetParam()), std::get<0>(GetParam())); }

INSTANTIATE_TEST_SUITE_P(Modes, LaserBounds,
                         testing::Combine(testing::Values("exact", "single"), testing::ValuesIn(kBoundCases)),
                         [](const auto& test) {
                           return std::string(std::get<0>(test.param)) + std::get<1>(test.param).name;
                         });

/// The bound of the reference is almost only the contact distance.
TEST(LaserBoundsOfCasters, TheReference) {
  for (const BoundCase& c : kBoundCases)
    if (c.exact_truth) expect_within_bounds(c, "exact", &raycast::reference_caster, 1);
}

}  // namespace
}  // namespace sf::trial
