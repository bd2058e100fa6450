// Many robots driven at random: what must hold whatever they do.

#include <gtest/gtest.h>

#include <cmath>

#include "base/hash.h"
#include "base/random.h"
#include "robots/fleet.h"
#include "tests/robots/scenes.h"

namespace sf::robots {
namespace {

using base::Pose;
using base::Report;
using base::Twist;
using base::Vec2;

constexpr std::int64_t kTick = 100'000'000;

world::World crowd() {
  world::World world = scenes::empty_world();
  scenes::add_bitmap(world, scenes::cave(60, 60, 3), 0.2);
  scenes::add_wall(world, {3, 3}, {9, 8.5});
  // On a lattice, where nothing is touched.
  for (int i = 0; i < 22 * 22; ++i) {
    const Pose X{0.6 + 0.5 * (i % 22), 0.6 + 0.5 * (i / 22), 0, 0.1 * i};
    world::World trial = world;
    const world::Mover& mover = i % 3 == 0   ? scenes::add_create(trial, X)
                                : i % 3 == 1 ? scenes::add_mover(trial, X, scenes::rectangle({0.03, 0}, 0.3, 0.15))
                                             : scenes::add_square(trial, X);
    std::vector<Edge> memory(mover.body.size());
    const Outline outline = outline_of(mover);
    const Placed placed = place(outline, X, memory);
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
    // Held for a second, so that robots get somewhere.
    const base::Draw draw{
        .seed = 5, .stream = base::Stream::slip, .a = std::uint32_t(row), .c = std::uint64_t(tick / 10)};
    const auto u = base::random_uniform(draw, 0), v = base::random_uniform(draw, 1);
    commands[row] = {1.2 * u[0] - 0.4, v[0] - 0.5, 4.0 * u[1] - 2.0};
  }
  return commands;
}

// By signed areas in long double, of everything against everything: not the code under test.
bool strictly_cross(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  const auto side = [](Vec2 p, Vec2 q, Vec2 r) {
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

TEST(Crowd, nothing_ever_crosses_anything) {
  const world::World world = crowd();
  ASSERT_GT(world.movers.size(), 60u);
  Fleet fleet(world);
  int contacts = 0;
  double travelled = 0.0;
  for (int tick = 0; tick < 1500; ++tick) {
    fleet.move(random_commands(world.movers.size(), tick), kTick);
    for (const auto contact : fleet.contacts()) contacts += contact;
    for (const auto& report : fleet.reports()) travelled += 0.1 * std::abs(report.velocity.forward);
    if (tick % 50 != 0) continue;
    ASSERT_EQ(crossings(world, fleet.reports()), 0) << "tick " << tick;
  }
  EXPECT_GT(contacts, 500) << "the crowd should be dense enough to test anything";
  EXPECT_GT(travelled, 500.0);
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

TEST(Crowd, the_same_run_again) {
  const world::World world = crowd();
  EXPECT_EQ(hash_of_run(world, 300), hash_of_run(world, 300));
}

TEST(Crowd, a_fixed_run_has_a_fixed_hash) { EXPECT_EQ(base::hash_text(hash_of_run(crowd(), 200)), "08017b7d969b0f65"); }

TEST(Crowd, what_is_far_away_changes_nothing) {
  world::World alone = scenes::boxed_world(6, 6), together = alone;
  scenes::add_create(alone, {3, 3, 0, 0});
  scenes::add_create(together, {3, 3, 0, 0});
  scenes::add_create(together, {50, 50, 0, 0});
  Fleet one(alone), two(together);
  for (int tick = 0; tick < 500; ++tick) {
    one.move(random_commands(1, tick), kTick);
    two.move(random_commands(2, tick), kTick);
    ASSERT_EQ(one.reports()[0].X_WM.x, two.reports()[0].X_WM.x);
    ASSERT_EQ(one.reports()[0].X_WM.yaw, two.reports()[0].X_WM.yaw);
  }
}

}  // namespace
}  // namespace sf::robots
