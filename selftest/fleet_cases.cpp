// Fleets: no robots, all at one place, a hundred thousand.

#include <fmt/format.h>

#include "selftest/exact_ray_cast.h"
#include "selftest/suite.h"

namespace sf::selftest {

namespace {

void nobody(Fixture& fixture, Checks& checks) {
  world::World world;
  add_room(world, {-1.0, -1.0}, 2.0);
  for (const world::World& w : {world::World{}, world}) {
    const TestFarm test = fixture.measure(w);
    checks.holds(test.readings.empty(), "no robots, no readings");
    for (int tick = 1; tick < 5; ++tick)
      checks.holds(test.farm->tick(tick * 1'000'000'000ll, {}).empty(), "none later either", tick);
  }
}

/// Robots at one place see each other's outlines from inside, all with the same ranges.
void coincident(Fixture& fixture, Checks& checks) {
  constexpr std::uint32_t kRobots = 100;
  world::World world;
  add_room(world, {-4.0, -4.0}, 8.0);
  for (std::uint32_t i = 0; i < kRobots; ++i)
    add_body(world, add_laser_mover(world, {0.5, 0.25, 0.0, 0.0}, laser(45, 2.0 * M_PI, 8.0)), 0.25);
  const TestFarm test = fixture.measure(world);
  world::World outline;
  add_block(outline, {0.25, 0.0}, {0.75, 0.5});
  checks.equal(test.readings.size(), kRobots, "readings");
  for (const base::ReadingBlock& r : test.readings)
    for (std::uint32_t i = 0; i < 45; ++i) {
      checks.same(r.values[i], test.readings[0].values[i], "all the same", r.mover);
      const Hit met = nearest_hit(outline.walls, beam_of(r.X_WS, laser(45, 2.0 * M_PI, 8.0), i), 8.0);
      checks.near(r.values[i], met.range, rounding(met), "the others' outline", r.mover);
    }
}

/// A grid of robots 1 m apart, each facing the back of the next: exactly 0.75 m; the last row sees none.
void a_hundred_thousand(Fixture& fixture, Checks& checks) {
  constexpr std::uint32_t kSide = 320, kRobots = 100'000;
  if (!casts_any_world(fixture)) {
    checks.holds(true, "left out");
    return checks.note("left out: more beams and surfaces than the chosen caster supports");
  }
  world::World world;
  for (std::uint32_t i = 0; i < kRobots; ++i) {
    const double x = i % kSide, y = i / kSide;
    add_body(world, add_laser_mover(world, {x, y, 0.0, 0.0}, laser(1, 0.0, 2.0)), 0.25);
  }
  const TestFarm test = fixture.measure(std::move(world));
  checks.equal(test.readings.size(), kRobots, "readings");
  for (const base::ReadingBlock& r : test.readings) {
    const bool last = r.mover % kSide == kSide - 1 || r.mover == kRobots - 1;
    checks.same(r.values[0], last ? 2.0 : 0.75, "the next robot's back", r.mover);
    checks.equal(r.hits[0], last ? base::kNoHit : test.world->movers[r.mover + 1].model, "by name", r.mover);
  }
}

constexpr Case kFleetCases[] = {
    {"fleets", "nobody", "", "a world without robots, with walls and without: no readings, no error", nobody},
    {"fleets", "coincident", "m", "100 robots in one place: each other's outlines within rounding, bitwise equal",
     coincident},
    {"fleets", "a-hundred-thousand", "m", "100 000 robots in rows: each sees the back of the next, exactly 0.75 m away",
     a_hundred_thousand},
};

}  // namespace

std::span<const Case> fleet_cases() { return kFleetCases; }

}  // namespace sf::selftest
