// Sight, screen and clearances: small questions with known answers.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "raycast/clearance.h"
#include "raycast/depth.h"
#include "raycast/screen.h"
#include "raycast/sight.h"
#include "tests/sensors/brute_force.h"
#include "tests/sensors/chance.h"
#include "tests/sensors/scenes.h"

namespace sf::raycast {
namespace {

TEST(Screen, CoversOnlyWhatLiesWhollyWithin) {
  constexpr double kBin = 2.0 * M_PI / Screen::kBins;
  Screen screen;
  EXPECT_FALSE(screen.covers(0.0, 0.1));
  screen.cover(0.1 * kBin, 0.9 * kBin);
  EXPECT_FALSE(screen.covers(0.2 * kBin, 0.8 * kBin)) << "less than a bin covers none";
  screen.cover(0.5 * kBin, 3.5 * kBin);
  EXPECT_TRUE(screen.covers(1.1 * kBin, 2.9 * kBin));
  EXPECT_FALSE(screen.covers(0.9 * kBin, 2.0 * kBin));
  EXPECT_FALSE(screen.covers(1.1 * kBin, 3.1 * kBin));
  screen.clear();
  EXPECT_FALSE(screen.covers(1.1 * kBin, 2.9 * kBin));
}

TEST(Screen, GoesRound) {
  Screen screen;
  screen.cover(-0.5, 0.5);
  EXPECT_TRUE(screen.covers(-0.4, 0.4));
  EXPECT_TRUE(screen.covers(2.0 * M_PI - 0.4, 2.0 * M_PI + 0.4));
  EXPECT_FALSE(screen.covers_all());
  screen.cover(0.4, 2.0 * M_PI - 0.4);
  EXPECT_TRUE(screen.covers_all());
  EXPECT_TRUE(screen.covers(-100.0, 100.0));
}

/// Whatever was covered, no direction outside of it is.
TEST(Screen, IsConservative) {
  trial::Chance chance(1);
  for (int i = 0; i < 2000; ++i) {
    Screen screen;
    const double low = chance.between(-7.0, 7.0);
    const double high = low + chance.between(0.0, 6.0);
    screen.cover(low, high);
    const double from = chance.between(-7.0, 7.0);
    const double to = from + chance.between(0.0, 1.0);
    bool within = false;
    for (const double turn : {-4.0 * M_PI, -2.0 * M_PI, 0.0, 2.0 * M_PI, 4.0 * M_PI})
      within = within || (from + turn >= low && to + turn <= high);
    EXPECT_TRUE(within || !screen.covers(from, to)) << low << ".." << high << " covers " << from << ".." << to;
  }
}

world::Segment wall(Vec2 a, Vec2 b) {
  world::Segment s;
  s.a = a;
  s.b = b;
  s.z_max = 1.0;
  return s;
}

TEST(Clearance, ByHand) {
  constexpr double kCap = 0.05;
  const world::Segment base = wall({0, 0}, {1, 0});
  const auto of_base = [&](const world::Segment& other) { return wall_clearances({base, other}, kCap)[0]; };
  EXPECT_NEAR(wall_clearances({base}, kCap)[0], 0.99 * kCap, 1e-7) << "alone: the cap";
  EXPECT_NEAR(of_base(wall({0, 1}, {1, 1})), 0.99 * kCap, 1e-7) << "far: the cap";
  EXPECT_NEAR(of_base(wall({0.2, 0.01}, {0.8, 0.02})), 0.99 * 0.01, 1e-7) << "near by";
  EXPECT_NEAR(of_base(wall({1.03, 0}, {2, 0})), 0.99 * 0.03, 1e-7) << "on one line";
  EXPECT_EQ(of_base(wall({0.5, -1}, {0.5, 1})), 0.0f) << "a crossing";
  EXPECT_EQ(of_base(wall({0.5, 0}, {0.5, 1})), 0.0f) << "a T-junction";
  EXPECT_EQ(of_base(wall({0, 0}, {1, 0})), 0.0f) << "the same again";
  EXPECT_EQ(of_base(wall({1, 0}, {0, 0})), 0.0f) << "the same, turned round";
  EXPECT_EQ(of_base(wall({0.5, 0}, {2, 0})), 0.0f) << "overlapping on one line";
  EXPECT_NEAR(of_base(wall({1, 0}, {1, 1})), 0.99 * kCap, 1e-7) << "a right angle at a shared end does not count";
  EXPECT_NEAR(of_base(wall({2, 0}, {1, 0})), 0.99 * kCap, 1e-7) << "straight on does not count";
  EXPECT_NEAR(of_base(wall({1, 0}, {0, std::tan(16 * M_PI / 180)})), 0.99 * kCap, 1e-7) << "16 degrees";
  EXPECT_LT(of_base(wall({1, 0}, {0, std::tan(14 * M_PI / 180)})), 1e-9f) << "14 degrees counts";
  EXPECT_LT(of_base(wall({1, 1e-12}, {1, 1})), 1e-11f) << "an end that is almost shared";
}

/// What every pair measured would say, to the bit.
void expect_measured(const std::vector<world::Segment>& walls, double cap, std::size_t stride) {
  const auto clearances = wall_clearances(walls, cap);
  for (std::size_t i = 0; i < walls.size(); i += stride) {
    double least = cap;
    for (std::size_t j = 0; j < walls.size(); ++j) {
      if (i == j) continue;
      const world::Segment &s = walls[i], &t = walls[j];
      least = std::min({least, world::distance(s.a, t.a, t.b), world::distance(s.b, t.a, t.b),
                        world::distance(t.a, s.a, s.b), world::distance(t.b, s.a, s.b)});
    }
    EXPECT_EQ(clearances[i], static_cast<float>(0.99 * least)) << "wall " << i << " of " << walls.size();
  }
}

/// `side` x `side` short walls, none of which touch.
std::vector<world::Segment> lattice(int side, double pitch) {
  std::vector<world::Segment> walls;
  trial::Chance chance(4);
  for (int i = 0; i < side * side; ++i) {
    const Vec2 p{pitch * (i % side), pitch * (i / side)};
    walls.push_back(wall(p, p + Vec2{0.5 * pitch, chance.between(-0.3, 0.3) * pitch}));
  }
  return walls;
}

TEST(Clearance, DenseWallsAreMeasuredAsSparseOnes) {
  for (const double pitch : {1e-4, 2e-3, 0.06, 1.0}) {
    std::vector<world::Segment> walls = lattice(30, pitch);
    walls.push_back(wall({-100.0, -2.0 * pitch}, {100.0, -2.5 * pitch}));
    for (const double cap : {0.05, 1e-3}) expect_measured(walls, cap, 7);
  }
}

/// The search begins near by where most walls are dense: what is far from all must look on.
TEST(Clearance, LonelyWallsBesideDenseOnes) {
  std::vector<world::Segment> walls = lattice(100, 0.002);
  const std::size_t first = walls.size();
  for (const Vec2 p : {Vec2{0.6, 0.6}, Vec2{0.9, 0.6}, Vec2{1.0, 1.0}, Vec2{0.3, 0.1}})
    walls.push_back(wall(p, p + Vec2{0.01, 0.02}));
  std::rotate(walls.begin(), walls.begin() + static_cast<std::ptrdiff_t>(first), walls.end());
  for (const double cap : {0.5, 0.05}) {
    for (int lonely = 0; lonely < 4; ++lonely) {
      expect_measured(walls, cap, walls.size());
      std::rotate(walls.begin(), walls.begin() + 1, walls.end());
    }
  }
}

/// The definition, checked against distances of many points.
TEST(Clearance, NothingComesNearer) {
  const world::World world = scenes::boxes(30, 6.0, 3);
  const auto clearances = wall_clearances(world.walls, 0.05);
  trial::Chance chance(2);
  for (std::size_t i = 0; i < world.walls.size(); ++i)
    for (int k = 0; k < 20; ++k) {
      const world::Segment& s = world.walls[i];
      const Vec2 p = s.a + chance.between(0.0, 1.0) * (s.b - s.a);
      for (std::size_t j = 0; j < world.walls.size(); ++j) {
        const world::Segment& t = world.walls[j];
        const auto same = [](Vec2 u, Vec2 v) { return u.x == v.x && u.y == v.y; };
        if (i == j || same(s.a, t.b) || same(s.b, t.a)) continue;  // neighbours of one outline: right angles here
        EXPECT_GE(world::distance(p, t.a, t.b), clearances[i]) << i << ", " << j;
      }
    }
}

TEST(Sight, FindsEverythingNear) {
  const world::World world = scenes::boxes(60, 16.0, 5);
  const Sight sight(world, 0.1, 8.0);
  Sight::Nearby nearby;
  trial::Chance chance(3);
  for (int i = 0; i < 200; ++i) {
    const Vec2 p = chance.in_square(10.0);
    const double radius = chance.between(0.01, 5.0);
    sight.near(p, radius, nearby);
    for (std::uint32_t k = 0; k < sight.segments().size(); ++k) {
      const bool near = world::distance(p, sight.segments()[k].a, sight.segments()[k].b) <= radius;
      const auto found = std::count(nearby.found.begin(), nearby.found.end(), k);
      EXPECT_TRUE(found == 1 || (found == 0 && !near));
    }
  }
}

TEST(Sight, KnowsInsideFromOutside) {
  world::World world;
  scenes::add_room(world, {}, 10.0);
  scenes::add_outline(world, {{0, 0}, {2, 0}, {2, 2}, {0, 2}}, "box");
  scenes::add_outline(world, {{1, 1}, {3, 1}, {3, 3}, {1, 3}}, "overlapping");
  const Sight sight(world, 0.1, 8.0);
  EXPECT_TRUE(sight.inside_solid({0.5, 0.5}));
  EXPECT_TRUE(sight.inside_solid({1.5, 1.5})) << "in both";
  EXPECT_TRUE(sight.inside_solid({5.05, 0.0})) << "in the ring of the room";
  EXPECT_FALSE(sight.inside_solid({-1.0, 0.0})) << "in the room";
  EXPECT_FALSE(sight.inside_solid({2.5, 0.5}));
  EXPECT_FALSE(sight.inside_solid({6.0, 0.0})) << "out of the room";
  EXPECT_FALSE(sight.inside_solid({1e9, -1e9}));
  EXPECT_FALSE(Sight({}, 0.1, 8.0).inside_solid({0, 0})) << "no walls";
}

TEST(Sight, DistanceToASegment) {
  EXPECT_DOUBLE_EQ(world::distance({0.5, 2}, {0, 0}, {1, 0}), 2.0);
  EXPECT_DOUBLE_EQ(world::distance({-3, 4}, {0, 0}, {1, 0}), 5.0) << "before its start";
  EXPECT_DOUBLE_EQ(world::distance({4, 4}, {0, 0}, {1, 0}), 5.0) << "behind its end";
}

/// Walls hide a disc only where every beam from the other disc to it meets a wall first.
TEST(Depth, HidesOnlyWhatIsHidden) {
  const world::World world = scenes::cave(300, 16.0, 3);
  const Sight sight(world, 0.1, 8.0);
  const Depth depth(sight, 20'000);
  Sight::Nearby scratch;
  trial::Chance chance(4);
  int hidden = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vec2 origin = chance.in_square(7.5);
    const Vec2 p = chance.in_square(7.5);
    const double radius = chance.between(0.05, 0.3);
    const double origin_radius = i % 2 ? chance.between(0.0, 0.2) : 0.0;
    if (length(p - origin) < radius + origin_radius + 0.01) continue;
    if (!depth.hides(origin, origin_radius, p, radius, scratch)) continue;
    ++hidden;
    for (int k = 0; k < 6; ++k) {
      const Vec2 from = origin + base::rotate(chance.between(0.0, 7.0), {origin_radius, 0.0});
      const Vec2 to = p + base::rotate(chance.between(0.0, 7.0), {radius, 0.0});
      const double distance = length(to - from);
      if (sight.inside_solid(from) || sight.inside_solid(to)) continue;
      const double range = oracle::cast(world.walls, from, std::atan2(to.y - from.y, to.x - from.x), 40.0).range;
      EXPECT_LT(range, distance) << "a beam reaches the disc";
    }
  }
  EXPECT_GT(hidden, 100);
}

/// Points are measured when they are asked for: in whatever order, by however many threads.
TEST(Depth, WhoeverAsksFirst) {
  const world::World world = scenes::cave(300, 16.0, 3);
  const Sight sight(world, 0.1, 8.0);
  constexpr std::size_t kAsked = 2000;
  const auto answers = [&](unsigned threads, bool backwards) {
    const Depth depth(sight, 20'000);
    base::Workers workers(threads);
    std::vector<Sight::Nearby> scratch(threads);
    std::vector<char> hidden(kAsked);
    workers.run(kAsked, 8, [&](std::size_t first, std::size_t last, unsigned thread) {
      for (std::size_t k = first; k < last; ++k) {
        const std::size_t i = backwards ? kAsked - 1 - k : k;
        trial::Chance chance(i);
        const Vec2 origin = chance.in_square(7.5);
        hidden[i] = depth.hides(origin, 0.0, chance.in_square(7.5), 0.2, scratch[thread]);
      }
    });
    return hidden;
  };
  const std::vector<char> once = answers(1, false);
  EXPECT_GT(std::count(once.begin(), once.end(), 1), 100);
  EXPECT_EQ(answers(1, true), once);
  EXPECT_EQ(answers(4, true), once);
}

}  // namespace
}  // namespace sf::raycast
