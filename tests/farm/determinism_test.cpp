// Equal calls give equal bytes, independent of threads, cache size and other robots.

#include <gtest/gtest.h>

#include "base/hash.h"
#include "raycast/casters.h"
#include "robots/kinematics.h"
#include "tests/farm/small_farm.h"
#include "tests/sensors/edit_laser.h"

namespace sf::farm {
namespace {

constexpr raycast::ScanNoise kNoise{.range_sigma = 0.01, .range_proportional = 0.005, .angle_sigma = 0.003};

std::uint64_t run(const world::World& world, const FarmOptions& options, int ticks = 12) {
  Farm farm(world, device(), options);
  farm.subscribe_all();
  for (int k = 0; k < ticks; ++k) farm.tick(k * 100'000'000ll, reports_at(world, k));
  EXPECT_EQ(farm.stats().readings, world.movers.size() * static_cast<std::size_t>(ticks));
  return farm.hash();
}

TEST(Determinism, TheSameSeedGivesTheSameBytes) {
  const world::World world = small_world(30, kNoise);
  EXPECT_EQ(run(world, {.seed = 1}), run(world, {.seed = 1}));
  EXPECT_NE(run(world, {.seed = 1}), run(world, {.seed = 2}));
}

TEST(Determinism, IndependentOfTheNumberOfThreads) {
  const world::World world = small_world(30, kNoise);
  const std::uint64_t one = run(world, {.seed = 1, .threads = 1});
  for (const unsigned threads : {2u, 3u, 7u}) EXPECT_EQ(run(world, {.seed = 1, .threads = threads}), one) << threads;
}

/// Samples between two ticks use the interpolated states. An absent mover's first report sets its pose.
TEST(Determinism, SamplesBetweenTicksUseInterpolatedStates) {
  const world::World world = small_world(30);
  Farm farm(world, device()), by_hand(world, device());
  farm.subscribe_all(), by_hand.subscribe_all();
  std::vector<base::Report> before;
  for (int k = 0; k < 6; ++k) {
    const std::int64_t now = 250'000'000ll * k;
    std::vector<base::Report> after = reports_at(world, k);
    for (base::Report& report : after) report.time = now;
    for (Farm* each : {&farm, &by_hand}) each->set_absent(7, k == 3);
    for (std::int64_t due = farm.next_due(); due < now; due = farm.next_due()) {
      std::vector<base::Report> states;
      for (std::size_t m = 0; m < after.size(); ++m)
        states.push_back(m == 7 && k == 4 ? after[m] : robots::interpolate(before[m], after[m], due));
      EXPECT_EQ(farm.sample_between(due, after).size(), by_hand.sample(due, states).size()) << k;
      EXPECT_EQ(farm.hash(), by_hand.hash()) << k;
    }
    farm.tick(now, after), by_hand.tick(now, after);
    EXPECT_EQ(farm.hash(), by_hand.hash()) << k;
    before = after;
  }
  EXPECT_GT(farm.stats().readings, 12u * 29u);
}

/// Sent ranges are infinite without a return; the hash covers the sent values.
TEST(Determinism, HashCoversSentValues) {
  const world::World world = small_world(30);
  Farm farm(world, device(), {.no_return_inf = true});
  Farm plain(world, device());
  farm.subscribe_all(), plain.subscribe_all();
  std::uint64_t of_sent = 0;
  std::size_t infinite = 0;
  for (int k = 0; k < 3; ++k) {
    std::vector<std::uint64_t> hashes;
    plain.tick(k * 100'000'000ll, reports_at(world, k));
    for (const base::ReadingBlock& r : farm.tick(k * 100'000'000ll, reports_at(world, k))) {
      std::vector<double> sent(r.values.begin(), r.values.end());
      for (std::size_t i = 0; i < sent.size(); ++i)
        if (r.hits[i] == base::kNoHit) sent[i] = HUGE_VAL, ++infinite;
      const std::uint64_t head[] = {r.mover, r.type, r.sensor, r.sequence, static_cast<std::uint64_t>(r.time)};
      std::uint64_t hash = base::hash_bytes(head, sizeof head);
      hash = base::hash_bytes(sent.data(), sent.size() * sizeof(double), hash);
      hashes.push_back(base::hash_bytes(r.hits.data(), r.hits.size_bytes(), hash));
    }
    of_sent = base::hash_bytes(hashes.data(), hashes.size() * sizeof hashes[0], of_sent);
  }
  EXPECT_GT(infinite, 0u);
  EXPECT_EQ(farm.hash(), of_sent);
  EXPECT_NE(farm.hash(), plain.hash());
}

/// The cache is so small that cells are evicted every tick and that it must grow within a tick.
TEST(Determinism, IndependentOfThePoolSize) {
  const world::World world = small_world(30, kNoise);
  const std::uint64_t large = run(world, {.seed = 1});
  for (const std::uint32_t chunks : {32u, 1024u, 16'384u})
    for (const std::uint32_t cells : {1u, 8u, 40u})
      EXPECT_EQ(run(world, {.seed = 1,
                            .scene = {.caster = &raycast::device_caster, .pool_chunks = chunks, .pool_cells = cells}}),
                large)
          << chunks << " chunks, " << cells << " cells";
}

TEST(Determinism, RebuildsEvictedCells) {
  const world::World world = small_world(30);
  Farm farm(world, device(), {.scene = {.caster = &raycast::device_caster, .pool_chunks = 16'384, .pool_cells = 32}});
  farm.subscribe_all();
  for (int k = 0; k < 12; ++k) farm.tick(k * 100'000'000ll, reports_at(world, k));
  Farm roomy(world, device(), {.scene = {.caster = &raycast::device_caster}});
  roomy.subscribe_all();
  for (int k = 0; k < 12; ++k) roomy.tick(k * 100'000'000ll, reports_at(world, k));
  EXPECT_GT(farm.stats().work.cells_built, roomy.stats().work.cells_built) << "the test is meant to evict";
  EXPECT_EQ(farm.hash(), roomy.hash());
}

/// Returns the readings of robot 0; `hear_others` subscribes the other robots too.
std::vector<Kept> of_first(const world::World& world, bool hear_others) {
  Farm farm(world, device(), {.seed = 3});
  farm.subscribe(0, kAllSensorTypes);
  if (hear_others) farm.subscribe_all();
  std::vector<Kept> kept;
  for (int k = 0; k < 6; ++k)
    for (const auto& r : farm.tick(k * 100'000'000ll, reports_at(world, k)))
      if (r.mover == 0) kept.push_back(keep(r));
  EXPECT_EQ(kept.size(), 6u);
  return kept;
}

/// Invisible robots change no reading: far away, behind walls, or not seen by lasers.
TEST(Determinism, InvisibleRobotsChangeNothing) {
  world::World alone;
  scenes::add_room(alone, {}, 6.0);
  scenes::add_outline(alone, {{1, -1}, {2, -1}, {2, 1}, {1, 1}}, "box");
  sensors::LaserSettings laser = scenes::laser(kBeams, 2.0 * M_PI, 8.0);
  laser.noise = kNoise;
  scenes::add_robot(alone, {-1, 0, 0, 0}, laser);
  const std::vector<Kept> expected = of_first(alone, false);

  world::World company = alone;
  for (int i = 0; i < 20; ++i) {
    scenes::add_robot(company, {100.0 + i, 3.0 * i, 0, 0}, laser);              // far away
    scenes::add_robot(company, {4.0 + 0.5 * i, 0.3 * i - 3.0, 0, 0.1}, laser);  // behind the room's wall
    scenes::add_robot(company, {-1.0 + 0.05 * i, 0.4, 0, 0.1}, laser);          // in the room, invisible to lasers
    for (world::Segment& s : company.movers.back().body) s.seen_by_laser = false;
  }
  EXPECT_EQ(of_first(company, true), expected);
  EXPECT_EQ(of_first(company, false), expected);
}

/// A robot's readings do not depend on the other sensors due in its tick.
TEST(Determinism, IndependentOfTheBatch) {
  world::World world = small_world(12, kNoise);
  const std::vector<Kept> alone = of_first(world, false);
  EXPECT_EQ(of_first(world, true), alone);
  for (std::size_t i = 1; i < world.movers.size(); ++i)
    scenes::edit_laser(world.movers[i])->rate = 1.0 + 2.0 * static_cast<double>(i);
  EXPECT_EQ(of_first(world, true), alone);
}

/// A sense request between ticks does not change later readings.
TEST(Determinism, SenseHasNoSideEffects) {
  const world::World world = small_world(5, kNoise);
  Farm asked(world, device(), {.seed = 1});
  Farm plain(world, device(), {.seed = 1});
  for (Farm* farm : {&asked, &plain}) {
    farm->subscribe_all();
    farm->tick(0, {});
  }
  const base::Pose elsewhere{0.5, 0.25, 0.0, 1.0};
  const base::ReadingBlock block = asked.sense(2, 1, 0, elsewhere);
  EXPECT_EQ(block.values.size(), kBeams);
  EXPECT_EQ(block.X_WM.x, 0.5);
  asked.tick(100'000'000, {});
  plain.tick(100'000'000, {});
  EXPECT_EQ(asked.hash(), plain.hash());
}

/// A fixed scene has a fixed hash.
TEST(Determinism, GoldenHash) {
  world::World world;
  scenes::add_room(world, {}, 12.0);
  for (int i = 0; i < 12; ++i) {
    const glm::dvec2 p{static_cast<double>(i % 4) * 2.5 - 4.0, static_cast<double>(i / 4) * 3.0 - 3.5};
    scenes::add_outline(world, {p, p + glm::dvec2{0.75, 0.25}, p + glm::dvec2{0.5, 1.0}}, "wedge");
  }
  for (int i = 0; i < 24; ++i) {
    const sensors::LaserSettings laser = scenes::laser(17, 2.0 * M_PI, 8.0);
    scenes::add_robot(world, {-5.0 + 0.375 * i, 5.0 - 0.25 * (7 * i % 40), 0.0, i * M_PI / 8}, laser);
  }
  EXPECT_EQ(base::hash_hex(run(world, {}, 3)), "1212340d30ce97fb");
}

}  // namespace
}  // namespace sf::farm
