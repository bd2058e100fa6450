// Crowds: movers inside, around and behind each other. Scans are bit-identical to 64-bit intersection with all
// segments, and cost about as much as scans of the same movers spread out.

#include "raycast/crowds.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>

#include "tests/raycast/host_scan.h"
#include "tests/sensors/chance.h"
#include "tests/sensors/scenes.h"

namespace sf::raycast {
namespace {

using trial::Chance;

constexpr double kHeight = 0.1;  // [m] of all beams

void set_body(world::Mover& mover, const std::vector<std::vector<glm::dvec2>>& loops) {
  world::Segment s = mover.body.front();
  mover.body.clear();
  mover.radius = 0.0;
  for (const auto& loop : loops)
    for (std::size_t i = 0; i < loop.size(); ++i) {
      s.a = loop[i], s.b = loop[(i + 1) % loop.size()];
      mover.body.push_back(s);
      mover.radius = std::max(mover.radius, length(s.a));
    }
}

void scale(world::Mover& mover, double factor) {
  for (world::Segment& s : mover.body) s.a = factor * s.a, s.b = factor * s.b;
  mover.radius *= factor;
}

std::vector<glm::dvec2> box(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

/// Returns the pose of the i-th mover of a layout.
using Layout = Pose (*)(int i, Chance& chance);

world::World crowd(int movers, Layout layout) {
  world::World world;
  scenes::add_room(world, {}, 100.0);
  Chance chance(5);
  for (int i = 0; i < movers; ++i) scenes::add_robot(world, layout(i, chance), scenes::laser());
  return world;
}

Pose spread_out(int i, Chance&) { return {3.0 * (i % 30) - 45.0, 3.0 * (i / 30) - 45.0, 0.0, 0.1 * i}; }
Pose at_one_pose(int, Chance&) { return {0.5, 0.25, 0.0, 0.3}; }
Pose turned_at_one_place(int, Chance& c) { return {0.5, 0.25, 0.0, c.between(-3.0, 3.0)}; }
template <int kNanometres>
Pose nearly_at_one_pose(int, Chance& c) {
  return {0.5 + 1e-9 * kNanometres * c.between(-1.0, 1.0), 0.25 + 1e-9 * kNanometres * c.between(-1.0, 1.0), 0.0, 0.3};
}
Pose in_a_line(int i, Chance&) { return {0.01 * i, 0.0, 0.0, M_PI}; }
Pose two_groups(int i, Chance& c) {
  return i % 2 == 0 ? Pose{0.01 * c.between(-1.0, 1.0), 0.01 * c.between(-1.0, 1.0), 0.0, 0.2}
                    : Pose{0.35 + 0.1 * c.between(0.0, 1.0), 0.3 * c.between(-1.0, 1.0), 0.0, 3.0};
}

/// Scans from every mover in one tick.
struct Swarm {
  explicit Swarm(const world::World& w, std::size_t beams = 181, double fov = M_PI, double range = 8.0)
      : world(w),
        configs(world),
        states(robots::states_at_load(world)),
        pattern(pattern_of(even_bearings(beams, fov))) {
    const std::uint32_t config = configs.add({kHeight, range, 0.0, 2.0 * M_PI});
    for (std::uint32_t m = 0; m < world.movers.size(); ++m) {
      Pose X = world.movers[m].X_WM;
      X.z = kHeight;
      views.push_back({config, m, X, {std::cos(X.yaw), std::sin(X.yaw)}});
    }
    scene.emplace(world, configs, thread_pool);
    scene->place_movers(states);
    scene->prepare(views);
  }
  Scan scan(std::size_t i) {
    Scan found{std::vector<double>(pattern.beams), std::vector<std::uint32_t>(pattern.beams)};
    std::vector<std::uint8_t> grazes(pattern.beams);
    scene->scan(i, {.heading = views[i].heading, .yaw = views[i].X_WS.yaw, .min_sine = 1e-3}, pattern, 0,
                {found.ranges.data(), found.models.data(), grazes.data()});
    return found;
  }
  /// Runs all scans and returns the number of segments projected or intersected.
  std::uint64_t work() {
    for (std::size_t i = 0; i < views.size(); ++i) scan(i);
    const ScanCounts counts = scene->counts();
    return kBlock * counts.blocks + counts.decisions;
  }

  world::World world;
  base::ThreadPool thread_pool{2};
  ListConfigs configs;
  std::vector<base::Report> states;
  ScanPattern pattern;
  std::vector<Viewpoint> views;
  std::optional<HostScene> scene;
};

void expect_exact(const world::World& world, const ScanPattern& pattern, double range, std::uint32_t step,
                  const std::string& name) {
  Swarm swarm(world, 3, 1.0, range);
  swarm.pattern = pattern;
  for (std::uint32_t m = 0; m < world.movers.size(); m += step)
    ASSERT_EQ(swarm.scan(m), intersect_everything(world, swarm.views[m].X_WS, m, pattern, range)) << name << ", " << m;
}

/// A thousand robots at one pose cost at most as much as a thousand that see each other at a distance.
TEST(Crowds, OnePoseCostsNoMoreThanSpreadOutRobots) {
  EXPECT_LE(Swarm(crowd(1'000, at_one_pose)).work(), Swarm(crowd(1'000, spread_out)).work());
}

/// The work of a scan hardly grows with the crowd: at most 48 segments per beam, in crowds with up to 16 000 segments.
TEST(Crowds, WorkPerBeamIsBounded) {
  const Layout layouts[] = {nearly_at_one_pose<1>,
                            nearly_at_one_pose<1'000>,
                            nearly_at_one_pose<1'000'000>,
                            nearly_at_one_pose<10'000'000>,
                            turned_at_one_place,
                            in_a_line,
                            two_groups};
  for (std::size_t k = 0; k < std::size(layouts); ++k)
    EXPECT_LE(Swarm(crowd(1'000, layouts[k])).work(), 1'000u * 181u * 48u) << k;
}

/// Robots with all headings at one place: each edge of the crowd is the nearest one somewhere, so scans read edges by
/// bearing.
TEST(Crowds, ManyVisibleEdgesAreReadByBearing) {
  const world::World world = crowd(300, turned_at_one_place);
  for (const std::size_t beams : {1, 2, 4, 61, 181})
    for (const double fov : {0.3, 2.0 * M_PI})
      expect_exact(world, pattern_of(even_bearings(beams, fov)), 8.0, 43, std::to_string(beams));
}

/// Bodies with two outlines: viewers are inside every mover's first outline and outside of the second, which is in
/// front of them.
TEST(Crowds, OuterOutlinesAreVisible) {
  world::World world = crowd(300, nearly_at_one_pose<1'000'000>);
  for (world::Mover& mover : world.movers) set_body(mover, {box(-1, -1, 1, 1), box(0.4, -0.3, 0.6, 0.3)});
  for (const double fov : {0.5, 2.0 * M_PI}) expect_exact(world, pattern_of(even_bearings(61, fov)), 8.0, 43, "two");
}

/// The wall is in front of the crowd's edges, touches them, or passes through the viewers.
TEST(Crowds, WallsHideEdgesReadByBearing) {
  for (const double x : {0.5, 0.55, 0.5 + 0.17}) {
    world::World world = crowd(300, turned_at_one_place);
    world::Segment wall = world.walls.front();
    wall.a = {x, -5.0}, wall.b = {x, 5.0}, wall.solid_left = false;
    world.walls.push_back(wall);
    expect_exact(world, pattern_of(even_bearings(181, 2.0 * M_PI)), 8.0, 43, std::to_string(x));
  }
}

/// The grid contains two of the movers with bit-identical poses. Scans hit the first; scans by the first hit the
/// second.
TEST(Crowds, CoincidentMoversReportTheFirst) {
  const world::World world = crowd(100, at_one_pose);
  Swarm swarm(world);
  EXPECT_EQ(swarm.scan(0).models[90], world.movers[1].model);
  EXPECT_EQ(swarm.scan(1).models[90], world.movers[0].model);
  EXPECT_EQ(swarm.scan(99).models[90], world.movers[0].model);
  MoverGeometry movers(world);
  std::vector<ExactSegment> exact(movers.segments());
  movers.place(swarm.states, swarm.thread_pool, exact);
  EXPECT_EQ(movers.grid().first.back(), 2u);
}

/// Movers at equal poses do not coincide if their outlines or heights differ.
TEST(Crowds, OnlyEqualOutlinesCoincide) {
  world::World world = crowd(40, at_one_pose);
  for (std::uint32_t m = 10; m < 20; ++m) scale(world.movers[m], 0.9);
  for (std::uint32_t m = 20; m < 30; ++m) world.movers[m].X_WM.z = 0.05;
  for (std::uint32_t m = 30; m < 40; ++m)
    for (world::Segment& s : world.movers[m].body) s.z_max = 0.05;
  expect_exact(world, pattern_of(even_bearings(91, 6.0)), 8.0, 5, "mixed outlines");
}

/// All kinds of patterns in all layouts of crowds, which include larger robots.
TEST(Crowds, AllPatternsAreExact) {
  const Layout layouts[] = {at_one_pose, turned_at_one_place, nearly_at_one_pose<1>, nearly_at_one_pose<1'000'000>,
                            in_a_line,   two_groups};
  for (const Layout layout : layouts)
    for (const double size : {1.0, 3.0}) {
      world::World world = crowd(60, layout);
      for (std::uint32_t m = 0; m < 60; m += 3) scale(world.movers[m], size);
      for (const std::size_t beams : {1, 3, 4, 64, 361})
        for (const double fov : {0.0, 0.3, M_PI, 2.0 * M_PI})
          expect_exact(world, pattern_of(even_bearings(beams, fov)), 8.0, 13, "a pattern");
    }
}

/// Random crowds: groups with offsets from picometres to metres, random or equal headings, discs, boxes, bodies with
/// two parts, various sizes, walls through them, near the origin and far away, and ranges shorter than the bodies.
TEST(Crowds, RandomCrowdsAreExact) {
  for (std::uint64_t seed = 1; seed <= 80; ++seed) {
    Chance chance(seed);
    world::World world = scenes::boxes(6, 8.0, seed);
    const double far = seed % 5 == 0 ? 1e5 : 0.0;
    const std::uint32_t groups = 1 + chance.below(3);
    const double offset = std::pow(10.0, chance.between(-12.0, 0.5)), turn = seed % 3 == 0 ? 0.0 : chance.between(0, 3);
    for (int i = 0; i < 40; ++i) {
      const glm::dvec2 group{0.3 * static_cast<double>(chance.below(groups)), 0.0}, p = chance.in_square(offset);
      const Pose X{group.x + p.x, group.y + p.y, 0.0, 0.3 + turn * chance.between(-1.0, 1.0)};
      world::Mover& mover = world.movers[scenes::add_robot(world, X, scenes::laser())];
      const std::uint32_t body = chance.below(seed % 4 + 1);
      if (body == 1) set_body(mover, {box(-0.2, -0.15, 0.25, 0.15)});
      if (body == 2) set_body(mover, {box(-0.2, -0.1, 0.2, 0.1), box(0.22, -0.2, 0.3, 0.2)});
      if (body == 3) scale(mover, chance.between(0.3, 2.0));
    }
    world::translate(world, far, -far);
    const std::string name = "crowd " + std::to_string(seed);
    expect_exact(world, pattern_of(even_bearings(61, 2.0 * M_PI)), seed % 7 == 0 ? 0.1 : 8.0, 7, name);
    expect_exact(world, pattern_of(even_bearings(2, 0.4)), 8.0, 7, name + ", two beams");
  }
}

/// Beams from lattice points to corners that all robots of a crowd share.
TEST(Crowds, BeamsThroughSharedCornersAreExact) {
  world::World world;
  for (int i = 0; i < 30; ++i) {
    world::Mover& mover =
        world.movers[scenes::add_robot(world, {0.25 * (i % 3), 0.25 * (i / 3 % 3), 0.0, M_PI_2 * (i % 4)}, {})];
    set_body(mover, {box(-1.0, -1.0, 1.0, 1.0)});
  }
  expect_exact(world, pattern_of(even_bearings(33, 2.0 * M_PI)), 8.0, 4, "a lattice");
}

}  // namespace
}  // namespace sf::raycast
