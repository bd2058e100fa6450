// Many robots with random commands: invariants of their motion.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "base/hash.h"
#include "base/random.h"
#include "base/thread_pool.h"
#include "robots/fleet.h"
#include "tests/instrumented.h"
#include "tests/robots/scenes.h"
#include "tests/units.h"

namespace sf::robots {
namespace {

using base::Pose;
using base::Report;
using base::Twist;

world::World crowd() {
  world::World world = scenes::empty_world();
  scenes::add_bitmap(world, scenes::cave(60, 60, 3), 0.2);
  scenes::add_wall(world, {3, 3}, {9, 8.5});
  // Starts on a lattice without contacts.
  for (int i = 0; i < 22 * 22; ++i) {
    const Pose X{0.6 + 0.5 * (i % 22), 0.6 + 0.5 * (i / 22), 0, 0.1 * i};
    world::World trial = world;
    const world::Mover& mover = i % 3 == 0   ? scenes::add_create(trial, X)
                                : i % 3 == 1 ? scenes::add_mover(trial, X, scenes::rectangle({0.03, 0}, 0.3, 0.15))
                                             : scenes::add_square(trial, X);
    std::vector<FootprintEdge> memory(mover.body.size());
    const Footprint outline = footprint_of(mover);
    const PlacedFootprint placed = place_footprint(outline, X, memory);
    bool clear = true;
    for (const auto& wall : world.walls) clear = clear && !touches(placed, wall);
    for (const auto& other : world.movers) {
      clear = clear && std::hypot(other.X_WM.x - X.x, other.X_WM.y - X.y) > other.radius + mover.radius;
    }
    if (clear) world = std::move(trial);
  }
  int row = 0;
  for (auto& mover : world.movers) mover.drive = ++row % 4 == 0 ? world::Drive::omni : world::Drive::differential;
  return world;
}

std::vector<Twist> random_commands(std::size_t count, int tick) {
  std::vector<Twist> commands(count);
  for (std::size_t row = 0; row < count; ++row) {
    // Commands last a second, so that robots cover some distance.
    const base::RandomKey draw{
        .seed = 5, .stream = base::RandomStream::slip, .a = std::uint32_t(row), .c = std::uint64_t(tick / 10)};
    const auto u = base::random_uniform(draw, 0), v = base::random_uniform(draw, 1);
    commands[row] = {1.2 * u[0] - 0.4, v[0] - 0.5, 4.0 * u[1] - 2.0};
  }
  return commands;
}

/// Drives the crowd into obstacles for 120 ticks, half of the time without turning, and returns the hash of all states.
/// @param disturb recomputes all contacts in each tick, as after a change from outside
std::uint64_t hash_of_contacts(const world::World& world, bool disturb) {
  Fleet fleet(world);
  std::uint64_t hash = 0;
  for (int tick = 0; tick < 120; ++tick) {
    std::vector<Twist> commands = random_commands(world.movers.size(), tick / 4);
    for (std::size_t row = tick % 80 < 40 ? 0 : commands.size(); row < commands.size(); ++row) commands[row].turn = 0.0;
    if (disturb) fleet.set_absent(0, false);
    fleet.move(commands, kTick);
    for (const Report& report : fleet.reports()) {
      const double state[] = {report.X_WM.x, report.X_WM.y, report.X_WM.yaw, double(report.contact_mask)};
      hash = base::hash_bytes(state, sizeof state, hash);
    }
    hash = base::hash_bytes(fleet.contacts().data(), fleet.contacts().size(), hash);
  }
  return hash;
}

// Movers that stay in contact keep their sectors as long as nothing near them moves.
TEST(Crowd, KeptContactsEqualComputedOnes) {
  const world::World world = crowd();
  EXPECT_EQ(hash_of_contacts(world, false), hash_of_contacts(world, true));
}

// Signed areas in long double for all pairs, independent of the code under test.
bool strictly_cross(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c, glm::dvec2 d) {
  const auto side = [](glm::dvec2 p, glm::dvec2 q, glm::dvec2 r) {
    return (static_cast<long double>(q.x) - p.x) * (static_cast<long double>(r.y) - p.y) -
           (static_cast<long double>(q.y) - p.y) * (static_cast<long double>(r.x) - p.x);
  };
  return side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0;
}

int crossings(const world::World& world, std::span<const Report> reports) {
  int count = 0;
  std::vector<std::vector<world::Segment>> bodies;
  for (const Report& report : reports) {
    bodies.push_back(world.movers[report.mover].body);
    for (auto& s : bodies.back()) s.a = transform(report.X_WM, s.a), s.b = transform(report.X_WM, s.b);
    for (const auto& s : bodies.back()) {
      for (const auto& wall : world.walls) count += strictly_cross(s.a, s.b, wall.a, wall.b);
      for (std::size_t other = 0; other + 1 < bodies.size(); ++other) {
        for (const auto& t : bodies[other]) count += strictly_cross(s.a, s.b, t.a, t.b);
      }
    }
  }
  return count;
}

TEST(Crowd, NothingEverOverlaps) {
  const world::World world = crowd();
  ASSERT_GT(world.movers.size(), 60u);
  Fleet fleet(world);
  int contacts = 0;
  double travelled = 0.0;
  const int ticks = instrumented() ? 300 : 1500;
  for (int tick = 0; tick < ticks; ++tick) {
    fleet.move(random_commands(world.movers.size(), tick), kTick);
    for (const auto contact : fleet.contacts()) contacts += contact;
    for (const auto& report : fleet.reports()) travelled += 0.1 * std::abs(report.velocity.forward);
    if (tick % 50 != 0) continue;
    ASSERT_EQ(crossings(world, fleet.reports()), 0) << "tick " << tick;
  }
  EXPECT_GT(contacts, ticks / 3) << "the crowd should be dense enough to test anything";
  EXPECT_GT(travelled, ticks / 3.0);
}

/// Free discs kept between ticks must not change results.
TEST(Crowd, MovesLikeANewlyBuiltFleet) {
  const world::World world = crowd();
  Fleet fleet(world);
  for (int tick = 0; tick < (instrumented() ? 30 : 200); ++tick) {
    const std::vector<Twist> commands = random_commands(world.movers.size(), tick);
    Fleet rebuilt(world);
    rebuilt.apply(fleet.reports());
    rebuilt.move(commands, kTick);
    fleet.move(commands, kTick);
    for (std::size_t row = 0; row < world.movers.size(); ++row) {
      const Pose &p = fleet.reports()[row].X_WM, &q = rebuilt.reports()[row].X_WM;
      ASSERT_TRUE(p.x == q.x && p.y == q.y && p.yaw == q.yaw) << "tick " << tick << " row " << row;
    }
  }
}

std::uint64_t hash_of_run(const world::World& world, int ticks) {
  Fleet fleet(world);
  std::uint64_t hash = 0;
  for (int tick = 0; tick < ticks; ++tick) {
    fleet.move(random_commands(world.movers.size(), tick), kTick);
    for (const Report& r : fleet.reports()) {
      const double state[] = {r.X_WM.x, r.X_WM.y, r.X_WM.yaw, r.velocity.forward, r.velocity.left, r.velocity.turn};
      hash = base::hash_bytes(state, sizeof state, hash);
    }
    hash = base::hash_bytes(fleet.contacts().data(), fleet.contacts().size(), hash);
  }
  return hash;
}

TEST(Crowd, RunHasAFixedHash) { EXPECT_EQ(base::hash_hex(hash_of_run(crowd(), 200)), "361222df6f8854e9"); }

std::vector<Twist> commands_by_id(const world::World& world, int tick) {
  const std::vector<Twist> by_id = random_commands(world.movers.size() + 1, tick);
  std::vector<Twist> commands;
  for (const world::Mover& mover : world.movers) commands.push_back(by_id[mover.id]);
  return commands;
}

/// Runs both fleets with the same commands for `ticks`, and expects bitwise equal states of each robot, by id.
/// @return number of ticks with contact, over all robots
int expect_same(const world::World& world, Fleet& fleet, const world::World& other_world, Fleet& other, int ticks) {
  std::map<std::uint32_t, std::uint32_t> other_row;
  for (std::uint32_t row = 0; row < other_world.movers.size(); ++row) other_row[other_world.movers[row].id] = row;
  int contacts = 0;
  for (int tick = 0; tick < ticks && !testing::Test::HasFailure(); ++tick) {
    fleet.move(commands_by_id(world, tick), kTick);
    other.move(commands_by_id(other_world, tick), kTick);
    for (std::uint32_t row = 0; row < world.movers.size(); ++row) {
      const std::uint32_t there = other_row.at(world.movers[row].id);
      const Report &p = fleet.reports()[row], &q = other.reports()[there];
      EXPECT_EQ(std::memcmp(&p.X_WM, &q.X_WM, sizeof p.X_WM), 0) << "tick " << tick << " row " << row;
      EXPECT_EQ(std::memcmp(&p.velocity, &q.velocity, sizeof p.velocity), 0);
      EXPECT_EQ(p.contact_mask, q.contact_mask);
      EXPECT_EQ(fleet.contacts()[row], other.contacts()[there]);
      contacts += fleet.contacts()[row];
    }
  }
  return contacts;
}

/// Too many robots for the room: they push each other from all sides.
world::World throng(int side) {
  world::World world = scenes::boxed_world(0.45 * side, 0.45 * side);
  for (int i = 0; i < side * side; ++i) {
    const Pose X{0.225 + 0.45 * (i % side), 0.225 + 0.45 * (i / side), 0, 0.7 * i};
    world::Mover& mover =
        i % 2 == 0 ? scenes::add_create(world, X) : scenes::add_mover(world, X, scenes::rectangle({}, 0.3, 0.25));
    if (i % 3 == 0) mover.drive = world::Drive::omni;
  }
  return world;
}

/// The number of distant movers must not change results either, nor their size, which sets the grid's cells.
TEST(Crowd, DistantMoversChangeNothing) {
  const world::World world = crowd();
  world::World more = world;
  for (int i = 0; i < 600; ++i) scenes::add_mover(more, {1000.0 + 5.0 * i, 0, 0, 0}, scenes::rectangle({}, 2.0, 2.0));
  Fleet fleet(world), other(more);
  const int ticks = instrumented() ? 50 : 200;
  EXPECT_GT(expect_same(world, fleet, more, other, ticks), 2 * ticks);
}

TEST(Crowd, OrderOfRowsChangesNothing) {
  for (const world::World& world : {crowd(), throng(6)}) {
    for (std::uint32_t k = 1; k <= (instrumented() ? 1u : 3u); ++k) {
      world::World mixed = world;
      auto& movers = mixed.movers;
      if (k == 1) std::reverse(movers.begin(), movers.end());
      for (std::size_t i = movers.size(); k > 1 && i-- > 1;) {
        const double u = base::random_uniform({.seed = k, .a = std::uint32_t(i)}, 0)[0];
        std::swap(movers[i], movers[static_cast<std::size_t>(u * static_cast<double>(i + 1))]);
      }
      Fleet fleet(world), other(mixed);
      EXPECT_GT(expect_same(world, fleet, mixed, other, 200), 100);
    }
  }
}

TEST(Crowd, ThreadsChangeNothing) {
  for (const world::World& world : {crowd(), throng(8)}) {
    for (const unsigned threads : {1u, 2u, 5u}) {
      if (instrumented() && threads == 2) continue;
      base::ThreadPool thread_pool(threads);
      Fleet alone(world), shared(world, &thread_pool);
      EXPECT_GT(expect_same(world, alone, world, shared, 150), 100);
    }
  }
}

/// Wider and faster robots elsewhere change the search for neighbours, but not its result. The same number of small
/// ones keeps the cells of the walls' index, and so the order of sums over walls.
TEST(Crowd, DistantCrowdChangesNothing) {
  const world::World alone = throng(7);
  world::World together = alone;
  for (int i = 0; i < 9; ++i) {
    scenes::add_mover(together, {500.0 + 3.0 * i, 0, 0, 0}, scenes::rectangle({}, 2.8, 1.5)).max_forward = 20.0;
    scenes::add_mover(together, {500.0 + 3.0 * i, 9, 0, 0}, scenes::rectangle({}, 0.1, 0.1));
  }
  Fleet one(alone), two(together);
  EXPECT_GT(expect_same(alone, one, together, two, 200), 100);
}

TEST(Crowd, NothingOverlapsInAThrong) {
  const world::World world = throng(7);
  base::ThreadPool thread_pool(2);
  Fleet fleet(world, &thread_pool);
  double travelled = 0.0;
  for (int tick = 0; tick < 400; ++tick) {
    fleet.move(random_commands(world.movers.size(), tick), kTick);
    for (const auto& report : fleet.reports()) travelled += 0.1 * std::abs(report.velocity.forward);
    ASSERT_EQ(crossings(world, fleet.reports()), 0) << "tick " << tick;
  }
  EXPECT_GT(travelled, 5.0);
}

/// Fast enough to pass through each other in one tick: 1 m per tick, 0.4 m wide.
TEST(Crowd, FastRobotsDoNotPassThroughEachOther) {
  for (std::uint32_t seed = 0; seed < 60; ++seed) {
    world::World world = scenes::empty_world();
    const auto u = base::random_uniform({.seed = 77, .a = seed}, 0);
    const double right = 3.0, y = 0.35 * (u[0] - 0.5);
    scenes::add_square(world, {0, 0, 0, 0}).max_forward = 10.0;
    scenes::add_square(world, {right, y, 0, M_PI}).max_forward = 10.0;
    if (seed % 2 == 1) std::swap(world.movers[0].id, world.movers[1].id);
    Fleet fleet(world);
    for (int tick = 0; tick < 5; ++tick) fleet.move(std::vector<Twist>{{10, 0, 0}, {10.0 * u[1], 0, 0}}, kTick);
    EXPECT_LT(fleet.reports()[0].X_WM.x, fleet.reports()[1].X_WM.x) << seed;
  }
}

TEST(Crowd, SmallerIdGoesFirstThroughAGap) {
  for (const bool swapped : {false, true}) {
    world::World world = scenes::empty_world();
    scenes::add_wall(world, {0, 0.22}, {0, 3});
    scenes::add_wall(world, {0, -0.22}, {0, -3});
    scenes::add_square(world, {-0.75, 0.0, 0, 0});
    scenes::add_square(world, {-0.30, 0.45, 0, 0});
    for (world::Mover& mover : world.movers) mover.drive = world::Drive::omni, mover.max_forward = 5.0;
    if (swapped) std::swap(world.movers[0].id, world.movers[1].id);
    // Both would be at the same place after this tick: one straight ahead, one from the side.
    Fleet fleet(world);
    fleet.move(std::vector<Twist>{{4.5, 0, 0}, {0.0, -2.0, 0}}, kTick);
    const double straight = fleet.reports()[0].X_WM.x, side = fleet.reports()[1].X_WM.y;
    EXPECT_EQ(fleet.contacts()[swapped ? 0 : 1], 1) << "the other is stopped in front of it";
    if (swapped) {
      EXPECT_NEAR(side, 0.25, 1e-9);
      EXPECT_NEAR(straight, -0.7, 5e-4);
    } else {
      EXPECT_NEAR(straight, -0.3, 1e-9);
      EXPECT_NEAR(side, 0.4, 5e-4);
    }
  }
}

/// A robot close behind a moving one is not stopped by the other's previous place, whichever id is smaller.
TEST(Crowd, CloseFollowerIsNotStopped) {
  for (const bool swapped : {false, true}) {
    world::World world = scenes::empty_world();
    for (int i = 0; i < 3; ++i) scenes::add_square(world, {-0.41 * i, 0, 0, 0});
    if (swapped) std::swap(world.movers[0].id, world.movers[2].id);
    Fleet fleet(world);
    for (int tick = 0; tick < 10; ++tick) {
      fleet.move(std::vector<Twist>(3, {0.5, 0, 0}), kTick);
      for (int i = 0; i < 3; ++i) ASSERT_EQ(fleet.contacts()[static_cast<std::size_t>(i)], 0) << tick << " " << i;
    }
    EXPECT_NEAR(fleet.reports()[2].X_WM.x, -0.82 + 0.5, 1e-9);
  }
}

/// Many robots push towards one place and take any direction when stopped: every robot gets through.
TEST(Crowd, AllRobotsGetThroughAGap) {
  world::World world = scenes::boxed_world(12, 6, {-6, -3});
  scenes::add_wall(world, {0, 0.4}, {0, 3});
  scenes::add_wall(world, {0, -0.4}, {0, -3});
  for (int i = 0; i < 20; ++i)
    scenes::add_create(world, {-0.5 - 0.4 * (i / 5), 0.4 * (i % 5) - 0.8, 0, 0}).drive = world::Drive::omni;
  Fleet fleet(world);
  std::vector<Twist> commands(20);
  int through = 0;
  for (int tick = 0; tick < 3000; ++tick) {
    for (std::size_t row = 0; row < 20; ++row) {
      const Pose& X = fleet.reports()[row].X_WM;
      const auto u = base::random_uniform({.seed = 3, .a = std::uint32_t(row), .c = std::uint64_t(tick / 5)}, 0);
      const glm::dvec2 goal = X.x < 0.3 ? glm::dvec2{0.4, 0.0} : glm::dvec2{5.5, 2.0 * u[0] - 1.0};
      const glm::dvec2 way = base::rotate(-X.yaw, goal - glm::dvec2{X.x, X.y});
      const glm::dvec2 v =
          fleet.contacts()[row] != 0 ? base::rotate(2.0 * M_PI * u[1], {0.3, 0}) : 0.4 / length(way) * way;
      commands[row] = {v.x, v.y, 0};
    }
    fleet.move(commands, kTick);
  }
  for (const Report& report : fleet.reports()) through += report.X_WM.x > 0.2;
  EXPECT_EQ(through, 20);
}

}  // namespace
}  // namespace sf::robots
