// States received by V2V as inputs of derived sensors.

#include <gtest/gtest.h>

#include <cmath>

#include "scenarios/simulation.h"
#include "sensors/aggregate.h"
#include "sensors/derived/derived_sensors.h"
#include "tests/device.h"
#include "tests/refusal.h"
#include "world/stage/build_world.h"

namespace sf::scenarios {
namespace {

constexpr std::size_t kValue = 0, kValid = 1, kAge = 4;

/// A centre that receives the states of two robots, of which one is out of range.
world::World watched_world(const std::string& input = "r1/v2v") {
  return world::build_world("watched.world",
                            "position( name \"centre\" derived( type \"aggregate\" rate 10 max_age 1 quantity \"x_m\" "
                            "inputs [\"" +
                                input + "\"] ) )\nposition( name \"r1\" pose [3 4 0 0] )\n" +
                                "position( name \"far\" pose [60 0 0 0] )",
                            {.sensors = sensors::world_file_words()});
}

/// The centre's readings in 3 s, in which all robots drive along x at 0.2 m/s.
std::vector<std::vector<double>> seen(const world::World& world, const std::optional<V2vLinkOptions>& v2v,
                                      unsigned threads = 1) {
  Simulation simulation(world, host_device(),
                        {.threads = threads, .actor = {.controller = {.name = ""}, .link = {}}, .v2v = v2v});
  std::vector<std::vector<double>> all;
  const std::vector<base::Twist> twists(world.movers.size(), {0.2, 0.0, 0.0});
  for (int tick = 0; tick < 30; ++tick) {
    for (const base::ReadingBlock& reading : simulation.step().readings)
      if (reading.type == sensors::kAggregate) all.emplace_back(reading.values.begin(), reading.values.end());
    simulation.command(twists);
  }
  return all;
}

TEST(V2vInputs, AreCurrentWithoutALink) {
  const auto rows = seen(watched_world(), std::nullopt);
  ASSERT_EQ(rows.size(), 30u);
  EXPECT_EQ(rows[0][kValue], 3.0);
  EXPECT_EQ(rows[20][kAge], 0.0);
  EXPECT_NEAR(rows[20][kValue], 3.0 + 0.2 * 1.9, 0.03) << "after two seconds, and a tick to start";
}

TEST(V2vInputs, AreLateWithALink) {
  V2vLinkOptions link{.rate = 5.0};
  link.link.delay = 0.3;
  const auto rows = seen(watched_world(), link);
  EXPECT_EQ(rows[2][kValid], 0.0) << "on its way";
  for (std::size_t k = 5; k < 30; ++k) EXPECT_NEAR(rows[k][kAge], k % 2 == 0 ? 0.4 : 0.3, 1e-9) << k;
  EXPECT_LT(rows[20][kValue], seen(watched_world(), std::nullopt)[20][kValue] - 0.05) << "an old place";
}

TEST(V2vInputs, LossLeavesAnOlderState) {
  V2vLinkOptions link;
  link.link.loss = 1.0;
  EXPECT_EQ(seen(watched_world(), link).back()[kValid], 0.0);
  link.link.loss = 0.5, link.link.jitter = 0.2;
  const auto once = seen(watched_world(), link), again = seen(watched_world(), link, 3);
  EXPECT_GT(once.back()[kAge], 0.0);
  for (std::size_t k = 0; k < once.size(); ++k)
    EXPECT_EQ(std::isnan(once[k][kValue]) ? 0.0 : once[k][kValue],
              std::isnan(again[k][kValue]) ? 0.0 : again[k][kValue])
        << k;
}

TEST(V2vInputs, HaveTheRangeOfTheRadio) {
  EXPECT_EQ(seen(watched_world("far/v2v"), std::nullopt).back()[kValid], 0.0);
  EXPECT_EQ(seen(watched_world("*/v2v"), std::nullopt).back()[kValid], 1.0) << "r1";
}

TEST(V2vInputs, NameAnotherRobot) {
  const auto refused = [](const std::string& input) {
    return refusal_of([&] {
      const world::World world = watched_world(input);
      sensors::check_derived_sensors(world, sensors::SensorSet(world));
    });
  };
  expect_in("'v2v' expects the robot whose states it receives", refused("v2v"));
  expect_in("a robot receives no states of its own", refused("centre/v2v"));
}

}  // namespace
}  // namespace sf::scenarios
