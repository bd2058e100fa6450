// Several worlds in one simulation of the public interface.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

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

// The table of readings is the farm's own buffer: the rows of worlds that go on must survive in it, and be written
// again by the next step.
TEST(Worlds, ARestartKeepsTheReadingsOfOthers) {
  Simulation worlds = room(3);
  go(worlds, 5);
  const auto scans = [&] {
    std::vector<std::vector<double>> rows;
    const Readings table = worlds.readings("laser");
    for (std::size_t i = 0; i < table.sensors; ++i) rows.emplace_back(table.row(i).begin(), table.row(i).end());
    return rows;
  };
  const auto before = scans();
  const std::uint32_t one[] = {1};
  const std::uint64_t seed[] = {9};
  for (int again = 0; again < 2; ++again) worlds.reset(one, seed);
  const auto after = scans(), start = [] {
    Simulation alone = room(1, 9);
    const Readings table = alone.readings("laser");
    return std::vector<std::vector<double>>{{table.row(0).begin(), table.row(0).end()},
                                            {table.row(1).begin(), table.row(1).end()}};
  }();
  EXPECT_EQ(after[0], before[0]);
  EXPECT_EQ(after[2], start[0]);
  EXPECT_EQ(after[3], start[1]);
  EXPECT_EQ(after[5], before[5]);
  EXPECT_NE(after[2], before[2]);
  go(worlds, 1);
  EXPECT_NE(scans()[5], before[5]);
}

/// With a latency, the first reading of the new episode is still to come.
TEST(Worlds, ARestartForgetsTheReadingsOfTheLastEpisode) {
  const std::string text =
      "model( size [1 9 1] pose [3 0 0 0] ) position( name \"bot\" drive \"diff\" laser( samples 3 rate 10 latency 0.3 "
      ") "
      "lidar( channels 1 columns 4 rate 10 latency 0.3 ) gyro( noise 1 rate 10 latency 0.3 ) )";
  Simulation worlds = Simulation::from_text(text, {.copies = 2}), alone = Simulation::from_text(text, {.seed = 9});
  go(worlds, 6);
  const std::uint32_t one[] = {1};
  const std::uint64_t seed[] = {9};
  worlds.reset(one, seed);
  for (int step = 0; step < 5; ++step) {
    for (const char* type : {"laser", "lidar", "gyro"}) {
      const Readings found = worlds.readings(type), expected = alone.readings(type);
      const auto same = [](const auto& a, const auto& b) {
        return std::ranges::equal(a, b, [](auto x, auto y) { return x == y || (x != x && y != y); });
      };
      EXPECT_TRUE(same(found.row(1), expected.row(0))) << type << step;
      EXPECT_TRUE(same(found.times.subspan(1), expected.times) && same(found.fresh.subspan(1), expected.fresh) &&
                  same(found.bounds.subspan(1), expected.bounds) && same(found.sigma.subspan(1), expected.sigma))
          << type << step;
      if (found.hits != nullptr) {
        EXPECT_TRUE(same(found.hits_of(1), expected.hits_of(0))) << type << step;
      }
      EXPECT_FALSE(std::isnan(found.row(0)[0])) << "the other world goes on";
    }
    go(worlds, 1), go(alone, 1);
  }
}

TEST(Worlds, GivenStartsCountExceptNan) {
  Simulation worlds = room(2);
  const std::uint32_t one[] = {1};
  const std::uint64_t seed[] = {9};
  const Pose starts[] = {{-2.0, 1.0, 0.0, 0.5}, {NAN, 0.0, 0.0, 0.0}, {NAN, 0.0, 0.0, 0.0}};
  worlds.reset(one, seed, {.poses = starts});
  EXPECT_EQ(worlds.poses()[3].y, 1.0);
  EXPECT_EQ(worlds.poses()[4].x, room(1, 9).poses()[1].x);
}

constexpr const char* kVaried = R"(
  define wall model( size [6 0.2 1] )
  wall( pose [0 3 0 0] ) wall( pose [0 -3 0 0] ) wall( pose [3 0 0 90] ) wall( pose [-3 0 0 90] )
  model( name "crate" size [0.5 0.8 1] pose [1 0 0 0] random_pose [0.5 2 90] random_size [0.3 0.5 0.5] )
  model( name "post" size [0.2 0.2 1] pose [-1 0 0 0] random_present 1 )
  position( name "bot" size [0.3 0.3 0.2] pose [-2 -2 0 0] drive "diff" acceleration_bounds [-1 1 0 0 0 0 -90 90]
    random_slip 0.3 random_acceleration 0.5 random_noise 0.8 gyro( noise 0.01 bias 0.01 rate 10 )
    encoder( per_count 0.001 slip 0.01 rate 10 ) laser( samples 31 fov 180 range_max 5 rate 10 noise [0.01 0 0.01] ) )
)";

Simulation varied(std::uint32_t copies, std::uint64_t seed) {
  return Simulation::from_text(kVaried, {.robots = 2, .seed = seed, .copies = copies}, "varied.world");
}

std::uint64_t varied_alone(std::uint64_t seed, int steps) {
  Simulation alone = varied(1, seed);
  go(alone, steps);
  return alone.hash();
}

TEST(Worlds, SizesSlipAndNoiseAreThoseOfTheirWorldAloneAlsoAfterARestart) {
  Simulation worlds = varied(3, 7);
  go(worlds, 12);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(worlds.hash(k), varied_alone(7 + k, 12)) << k;
  const std::uint32_t some[] = {2, 0};
  const std::uint64_t seeds[] = {20, 30};
  worlds.reset(some, seeds);
  go(worlds, 12);
  EXPECT_EQ(worlds.hash(0), varied_alone(30, 12));
  EXPECT_EQ(worlds.hash(1), varied_alone(8, 24));
  EXPECT_EQ(worlds.hash(2), varied_alone(20, 12));
}

TEST(Worlds, SlipShortensTheWayAndNotTheEncoders) {
  Simulation worlds = Simulation::from_text(
      "position( name \"bot\" drive \"diff\" encoder( per_count 0.0001 rate 10 ) )", {.copies = 2}, "slip.world");
  const std::uint32_t both[] = {0, 1};
  const std::uint64_t seeds[] = {1, 2};
  const double slip[] = {NAN, 0.25};
  worlds.reset(both, seeds, {.slip = slip});
  worlds.step(std::vector<Twist>(2, {0.4, 0.0, 0.0}));
  for (int i = 0; i < 9; ++i) worlds.step();
  EXPECT_NEAR(worlds.poses()[0].x, 0.4, 1e-12);
  EXPECT_NEAR(worlds.poses()[1].x, 0.3, 1e-12);
  for (const std::size_t row : {0u, 1u}) EXPECT_NEAR(worlds.readings("encoder").row(row)[0], 0.4, 1e-9) << row;
}

TEST(Worlds, GivenSizesPresenceAndNoiseHoldUntilTheNextRestart) {
  Simulation worlds = varied(2, 7);
  const std::uint32_t one[] = {1};
  const std::uint64_t seed[] = {9};
  const double kNan = NAN;
  const std::array<double, 3> sizes[] = {{kNan}, {kNan}, {0.6, 0.8, 1.0}, {kNan}};  // of two robots, crate and post
  const double present[] = {1.0, kNan, kNan, 0.0}, noise[] = {0.0, 0.0, kNan, kNan};
  worlds.reset(one, seed, {.present = present, .sizes = sizes, .noise = noise});
  EXPECT_DOUBLE_EQ(worlds.radii()[6], 0.5);
  EXPECT_EQ(worlds.present()[7], 0);
  EXPECT_EQ(worlds.readings("gyro").row(2)[0], 0.0);  // at rest, and without noise
  EXPECT_NE(worlds.readings("gyro").row(0)[0], 0.0);
  worlds.reset(one, seed);
  go(worlds, 5);
  EXPECT_EQ(worlds.hash(1), varied_alone(9, 5));
}

TEST(Worlds, RefuseStartsOutOfRangeByName) {
  Simulation worlds = varied(1, 7);
  const std::uint32_t one[] = {0};
  const std::uint64_t seed[] = {9};
  const auto refused = [&](const WorldStarts& starts) {
    return sf::refusal_of<Error>([&] { worlds.reset(one, seed, starts); });
  };
  const auto with = [](std::size_t row, double value) {
    std::vector<double> rows(4, NAN);
    rows[row] = value;
    return rows;
  };
  const auto sized = [](std::size_t row, std::array<double, 3> size) {
    std::vector<std::array<double, 3>> rows(4, {NAN, 0.0, 0.0});
    rows[row] = size;
    return rows;
  };
  EXPECT_EQ(refused({.slip = with(1, 1.0)}), "the slip of 'bot2' is 1; expected a number from 0 to 0.9");
  EXPECT_EQ(refused({.noise = with(2, 0.5)}), "'crate' is not a robot, and has no noise");
  EXPECT_EQ(refused({.acceleration = with(0, 0.0)}),
            "the acceleration of 'bot1' is 0; expected a number from 0.01 to 1");
  EXPECT_EQ(refused({.present = with(0, 0.0)}), "'bot1' is a robot, and cannot be missing");
  EXPECT_EQ(refused({.present = with(2, 0.5)}), "'present' of 'crate' is 0.5; expected 0 or 1");
  sf::expect_in("it is a robot", refused({.sizes = sized(0, {1.0, 1.0, 1.0})}));
  sf::expect_in("the size of 'post' is (-1, 1, 1)", refused({.sizes = sized(3, {-1.0, 1.0, 1.0})}));
  sf::expect_in("(1, nan, 1)", refused({.sizes = sized(3, {1.0, NAN, 1.0})}));
  EXPECT_EQ(refused({.slip = std::vector<double>(3, NAN)}), "3 slips for 4 rows; expected one per row, or none");
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
  EXPECT_EQ(refused(one, std::span(seeds, 1), WorldStarts{std::span(wrong, 1)}),
            "1 starts for 3 rows; expected one per row, or none");
  EXPECT_NE(refused(one, std::span(seeds, 1), WorldStarts{wrong}), "");
  EXPECT_EQ(worlds.hash(1), before);
  EXPECT_NE(sf::refusal_of<Error>([&] { static_cast<void>(worlds.hash(2)); }), "");
  sf::expect_in("expected one world", sf::refusal_of<Error>([&] { worlds.set_shape(0, {.color = "blue"}); }));
  for (const Options& options :
       {Options{.copies = 2, .positioning = "rate = 10"},
        Options{.copies = 2, .faults = "[[fault]]\nrobot = '*'\nsensor = 'laser'\nkind = 'stuck'"}})
    sf::expect_in("expected one", sf::refusal_of<Error>([&] { Simulation::from_text(kRoom, options); }));
  EXPECT_NE(sf::refusal_of<Error>([] { Simulation::from_text(kRoom, {.copies = 0}); }), "");
  EXPECT_EQ(sf::refusal_of<Error>(
                [] { Simulation::from_text(kRoom, {.copies = 2, .record = "out/never", .record_world = 2}); }),
            "there is no world 2 to record; expected less than 2");
}

TEST(Worlds, MapsBeginUnexplored) {
  const auto text = [](const char* keys) {
    return std::string(
               "model( pose [1 0 0 0] size [0.2 3 1] ) position( name \"bot\" size [0.2 0.2 0.2] drive \"diff\" "
               "laser( range_max 2 rate 10 ) sonar( ) occupancy( name \"map\" words [10 10] cell 0.1 rate 10 ") +
           keys + " ) )";
  };
  for (const char* keys : {"", "log_odds 1", "sources [\"laser\" \"sonar\"]"}) {
    Simulation worlds = Simulation::from_text(text(keys), {.copies = 2}, "map.world");
    go(worlds, 5);
    const std::uint32_t one[] = {1};
    const std::uint64_t seed[] = {8};
    worlds.reset(one, seed);
    go(worlds, 4);
    Simulation alone = Simulation::from_text(text(keys), {.seed = 8}, "map.world");
    go(alone, 4);
    EXPECT_EQ(worlds.hash(1), alone.hash()) << keys;
  }
}

/// Counts its readings, and sees the robots of its world only.
struct Counter : Sensor {
  mutable double count = 0.0;
  void read(const Measurement& m, std::span<double> values) const override {
    values[0] = ++count;
    values[1] = static_cast<double>(m.around.robots()) + m.around.pose(0).x;
    values[2] = m.around.cast(m.X_WS.x, m.X_WS.y, 0.1, m.X_WS.yaw, 3.0).range;
  }
};

TEST(Worlds, UsersSensorsSeeTheirWorldAndAreReplacedAtARestart) {
  add_sensor({.name = "counter",
              .id = 25,
              .columns = {{"count"}, {"robots"}, {"ahead_m"}},
              .keys = {},
              .rate = 10.0,
              .kernel = "",
              .make = [](const SensorSite&, const SensorSettings&) { return std::make_unique<Counter>(); }});
  const auto make = [](std::uint32_t copies, std::uint64_t seed) {
    return Simulation::from_text(
        "position( name \"bot\" size [0.3 0.3 0.3] drive \"diff\" counter( ) ) "
        "model( name \"crate\" size [0.3 5 1] pose [1.5 0 0 0] random_pose [0.5 0 0] random_size [0.2 0 0] )",
        {.seed = seed, .copies = copies}, "counter.world");
  };
  Simulation worlds = make(2, 1);
  go(worlds, 3);
  const std::uint32_t one[] = {1};
  const std::uint64_t seed[] = {5};
  worlds.reset(one, seed);
  go(worlds, 3);
  for (const std::size_t k : {0u, 1u}) {
    Simulation alone = make(1, k == 0 ? 1 : 5);
    go(alone, k == 0 ? 6 : 3);
    EXPECT_EQ(worlds.hash(k), alone.hash()) << k;
  }
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
