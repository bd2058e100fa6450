// Several worlds in one simulation of the public interface.

#include <gtest/gtest.h>

#include <cmath>

#include "sensorfarm/simulation.h"
#include "tests/refusal.h"

namespace sensorfarm {
namespace {

constexpr const char* kRoom = R"(
  define wall model( size [6 0.2 1] )
  wall( pose [0 3 0 0] ) wall( pose [0 -3 0 0] ) wall( pose [3 0 0 90] ) wall( pose [-3 0 0 90] )
  model( name "crate" size [0.5 0.8 1] pose [1 0 0 0] random_pose [0.5 2 90] random_present 0.6 )
  position( name "bot" size [0.3 0.3 0.2] pose [-2 -2 0 0] drive "diff"
    laser( samples 31 fov 180 range_max 5 rate 10 noise [0.01 0 0] ) )
)";

Simulation room(std::uint32_t copies, std::uint64_t seed = 1) {
  return Simulation::from_text(kRoom, {.robots = 2, .seed = seed, .copies = copies}, "room.world");
}

void go(Simulation& simulation, int steps) {
  const std::vector<Twist> ahead(simulation.size(), Twist{0.3, 0.0, 0.2});
  for (int i = 0; i < steps; ++i) simulation.step(ahead);
}

std::uint64_t hash_alone(std::uint64_t seed, int steps) {
  Simulation alone = room(1, seed);
  go(alone, steps);
  return alone.hash();
}

TEST(Worlds, RowsFollowEachOther) {
  const Simulation worlds = room(3);
  EXPECT_EQ(worlds.copies(), 3u);
  EXPECT_EQ(worlds.robots().size(), 3u);  // two robots and the crate
  EXPECT_EQ(worlds.size(), 9u);
  EXPECT_EQ(worlds.readings("laser").sensors, 6u);
  EXPECT_EQ(worlds.readings("laser").robots[2], 3u);
}

TEST(Worlds, EachHasTheBytesOfItsWorldAlone) {
  Simulation worlds = room(3, 7);
  go(worlds, 20);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(worlds.hash(k), hash_alone(7 + k, 20)) << k;
}

TEST(Worlds, AResetOfAllBeginsWithConsecutiveSeeds) {
  Simulation worlds = room(2);
  go(worlds, 5);
  worlds.reset(30);
  EXPECT_EQ(worlds.time(), 0.0);
  EXPECT_EQ(worlds.tick(1), 0u);
  go(worlds, 4);
  EXPECT_EQ(worlds.hash(1), hash_alone(31, 4));
  EXPECT_DOUBLE_EQ(worlds.time(1), 0.4);
}

TEST(Worlds, GivenStartsCountExceptNan) {
  Simulation worlds = room(2);
  const std::uint32_t one[] = {1};
  const std::uint64_t seed[] = {9};
  const Pose starts[] = {{-2.0, 1.0, 0.0, 0.5}, {NAN, 0.0, 0.0, 0.0}, {NAN, 0.0, 0.0, 0.0}};
  worlds.reset(one, seed, starts);
  EXPECT_EQ(worlds.poses()[3].y, 1.0);
  EXPECT_EQ(worlds.poses()[4].x, room(1, 9).poses()[1].x);
}

TEST(Worlds, Refusals) {
  Simulation worlds = room(2);
  const std::uint64_t before = worlds.hash(1);
  const std::uint32_t unknown[] = {2}, twice[] = {1, 1}, one[] = {1};
  const std::uint64_t seeds[] = {1, 2};
  const Pose wrong[] = {{0.0, HUGE_VAL, 0.0, 0.0}, {}, {}};
  const auto refused = [&](auto&&... given) { return sf::refusal_of<Error>([&] { worlds.reset(given...); }); };
  EXPECT_EQ(refused(unknown, std::span(seeds, 1)), "there is no world 2; expected less than 2");
  EXPECT_EQ(refused(twice, seeds), "world 1 is given twice; expected each once");
  EXPECT_EQ(refused(one, seeds), "2 seeds for 1 worlds; expected as many");
  EXPECT_EQ(refused(one, std::span(seeds, 1), std::span(wrong, 1)),
            "1 starts for 3 rows; expected one per row, or none");
  EXPECT_NE(refused(one, std::span(seeds, 1), wrong), "");
  EXPECT_EQ(worlds.hash(1), before);
  EXPECT_NE(sf::refusal_of<Error>([&] { static_cast<void>(worlds.hash(2)); }), "");
  sf::expect_in("expected one world", sf::refusal_of<Error>([&] { worlds.set_shape(0, {.color = "blue"}); }));
  for (const Options& options :
       {Options{.copies = 2, .record = "out/never"}, Options{.copies = 2, .positioning = "rate = 10"},
        Options{.copies = 2, .faults = "[[fault]]\nrobot = '*'\nsensor = 'laser'\nkind = 'stuck'"}})
    sf::expect_in("expected one", sf::refusal_of<Error>([&] { Simulation::from_text(kRoom, options); }));
  EXPECT_NE(sf::refusal_of<Error>([] { Simulation::from_text(kRoom, {.copies = 0}); }), "");
}

TEST(Worlds, MapsRefuseToBeginAnewWithTheirName) {
  const std::string text = "position( name \"bot\" laser( range_max 2 ) occupancy( name \"map\" ) )";
  Simulation worlds = Simulation::from_text(text, {.copies = 2}, "map.world");
  const std::uint32_t one[] = {1};
  const std::uint64_t seed[] = {1};
  sf::expect_in("the map 'map' cannot begin anew", sf::refusal_of<Error>([&] { worlds.reset(one, seed); }));
}

TEST(Observations, RefuseOptionsOutOfRange) {
  Simulation simulation = room(1);
  for (const ObservationOptions& options :
       {ObservationOptions{.every = 0}, ObservationOptions{.stack = 0}, ObservationOptions{.stack = 1'001},
        ObservationOptions{.goal_reach = -1.0}, ObservationOptions{.goal_reach = HUGE_VAL},
        ObservationOptions{.sensor = "sonar"}})
    EXPECT_NE(sf::refusal_of<Error>([&] { simulation.observe(options); }), "");
}

TEST(Observations, WithoutAGoalTheColumnsAreOneAndZeros) {
  Simulation simulation = room(1);
  const Observations seen = simulation.observe({.every = 31, .speeds = false, .goal_reach = 4.0});
  ASSERT_EQ(seen.columns(), 4u);
  EXPECT_EQ(std::vector<float>(seen.values().begin() + 1, seen.values().begin() + 4), (std::vector<float>{1, 0, 0}));
}

TEST(Observations, AreWrittenWhileTheirHandleExists) {
  Simulation simulation = room(2);
  const Observations seen = simulation.observe({.stack = 2});
  { const Observations forgotten = simulation.observe(); }
  const std::vector<float> before(seen.values().begin(), seen.values().end());
  go(simulation, 1);
  const std::size_t newest = seen.columns() / 2;
  EXPECT_TRUE(std::equal(before.begin(), before.begin() + static_cast<std::ptrdiff_t>(newest),
                         seen.values().begin() + static_cast<std::ptrdiff_t>(newest)));
  EXPECT_EQ(seen.ages()[0], 1u);
}

}  // namespace
}  // namespace sensorfarm
