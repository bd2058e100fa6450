#include "scenarios/v2v_link.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "base/time.h"
#include "scenarios/scenario.h"
#include "scenarios/simulation.h"
#include "sensors/sensor_type.h"
#include "tests/device.h"
#include "tests/units.h"
#include "tests/world/read_world.h"

namespace sf::scenarios {
namespace {

constexpr V2vLink::Ids kIds{7, 8};

/// Row 0 drives at 1 m/s along x, and heads for the checkpoint with the tick's number.
struct Radio {
  explicit Radio(const V2vLinkOptions& options) : link(options, 1) {}
  void send(std::uint32_t tick, bool absent = false) {
    const Broadcast sent{{0, tick * kTick, {0.1 * tick, 0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}}, {.checkpoint = tick}};
    link.send(sent.state.time, {&sent, 1}, {absent});
  }
  std::optional<Broadcast> received(std::uint32_t tick, const V2vLink::Ids& ids = kIds) const {
    return link.receive(tick * kTick, 0, ids);
  }
  V2vLink link;
};

TEST(V2vLink, APerfectLinkGivesThePresentState) {
  Radio radio({});
  for (std::uint32_t tick = 0; tick < 20; ++tick) {
    radio.send(tick);
    EXPECT_EQ(radio.received(tick)->state.X_WM.x, 0.1 * tick);
    EXPECT_EQ(radio.received(tick)->state.time, tick * kTick);
    EXPECT_EQ(radio.received(tick)->intent.checkpoint, tick);
  }
}

TEST(V2vLink, StatesAndIntentsAreAsOldAsTheDelay) {
  Radio radio({.link = {.delay = 0.3}});
  for (std::uint32_t tick = 0; tick < 20; ++tick) {
    radio.send(tick);
    ASSERT_EQ(radio.received(tick).has_value(), tick >= 3);
    if (tick < 3) continue;
    EXPECT_NEAR(radio.received(tick)->state.X_WM.x, 0.1 * tick - 0.3, 1e-12);
    EXPECT_EQ(radio.received(tick)->intent.checkpoint, tick - 3);
  }
}

/// Between two broadcasts, the receiver extrapolates.
TEST(V2vLink, BroadcastsHaveARate) {
  Radio radio({.rate = 2.0});
  for (std::uint32_t tick = 0; tick < 20; ++tick) {
    radio.send(tick);
    EXPECT_NEAR(radio.received(tick)->state.X_WM.x, 0.1 * tick, 1e-12);
    EXPECT_EQ(radio.received(tick)->intent.checkpoint, tick / 5 * 5);
  }
}

TEST(V2vLink, AnOvertakenBroadcastIsIgnored) {
  Radio radio({.link = {.delay = 0.0, .jitter = 0.35, .seed = 3}});
  std::uint32_t last = 0;
  for (std::uint32_t tick = 0; tick < 300; ++tick) {
    radio.send(tick);
    const auto received = radio.received(tick);
    if (!received) continue;
    EXPECT_GE(received->intent.checkpoint, last);
    EXPECT_GE(received->intent.checkpoint + 4, tick) << "none takes longer than 0.35 s";
    last = received->intent.checkpoint;
  }
}

/// Binomial: within four standard deviations of the mean, for each of two receivers, which lose different broadcasts.
TEST(V2vLink, LossIsIndependentPerReceiver) {
  Radio radio({.link = {.loss = 0.3, .seed = 4}});
  int lost = 0, both = 0;
  constexpr int kTicks = 4000;
  for (std::uint32_t tick = 0; tick < kTicks; ++tick) {
    radio.send(tick);
    const auto misses = [&](std::uint32_t receiver) {
      const auto received = radio.received(tick, {receiver, 8});
      return !received || received->intent.checkpoint != tick;
    };
    lost += misses(7) ? 1 : 0;
    both += misses(7) && misses(9) ? 1 : 0;
  }
  EXPECT_NEAR(lost, 0.3 * kTicks, 4.0 * std::sqrt(kTicks * 0.3 * 0.7));
  EXPECT_NEAR(both, 0.09 * kTicks, 4.0 * std::sqrt(kTicks * 0.09 * 0.91));
}

TEST(V2vLink, ASilentRobotIsForgotten) {
  Radio radio({.forget = 0.5, .link = {.delay = 0.2}});
  for (std::uint32_t tick = 0; tick < 20; ++tick) {
    radio.send(tick, tick > 5);
    // The last broadcast was sent at tick 5; it is kept for 0.2 + 0.5 s.
    EXPECT_EQ(radio.received(tick).has_value(), tick >= 2 && tick <= 12) << tick;
  }
}

TEST(V2vLink, NothingArrivesIfAllIsLost) {
  Radio radio({.link = {.loss = 1.0}});
  for (std::uint32_t tick = 0; tick < 20; ++tick) {
    radio.send(tick);
    EXPECT_FALSE(radio.received(tick));
  }
}

/// A robot that has joined since has sent nothing.
TEST(V2vLink, RobotsMayJoin) {
  V2vLink link({}, 1);
  const Broadcast first{{0, 0, {}, {}}, {}};
  const std::vector<Broadcast> two{{{0, kTick, {}, {}}, {}}, {{1, kTick, {5.0, 0.0, 0.0, 0.0}, {}}, {}}};
  link.send(0, {&first, 1}, {false});
  EXPECT_FALSE(link.receive(0, 1, kIds));
  link.send(kTick, two, {false, false});
  EXPECT_EQ(link.receive(kTick, 1, kIds)->state.X_WM.x, 5.0);
}

TEST(V2vLink, BroadcastsInTransitAreBounded) {
  EXPECT_NO_THROW(V2vLink({.forget = 0.0, .link = {.delay = 999.0}}, 1000));
  EXPECT_THROW(V2vLink({.forget = 1.0, .link = {.delay = 1000.0}}, 1000), base::InputError);
}

/// Returns the hash of a convoy's readings.
std::uint64_t convoy(const std::optional<V2vLinkOptions>& v2v) {
  Scenario scenario = read_scenario(SF_SOURCE_DIR "/experiments/simville-merge.toml");
  scenario.v2v = v2v;
  const world::World world = world_of(scenario);
  Simulation simulation(world, device(), simulation_of(scenario, world));
  for (int tick = 0; tick < 100; ++tick) simulation.step();
  return simulation.farm().hash();
}

TEST(V2vLink, ReachesControllers) {
  const std::uint64_t current = convoy(std::nullopt);
  EXPECT_EQ(convoy(V2vLinkOptions{}), current) << "without delay, broadcasts are current";
  const std::uint64_t late = convoy(V2vLinkOptions{.link = {.delay = 0.5}});
  EXPECT_NE(late, current);
  EXPECT_EQ(convoy(V2vLinkOptions{.link = {.delay = 0.5}}), late);
}

/// A leader whose wheels count 30 % too much patrols ahead of a follower that keeps a distance of 1 m by V2V.
struct Pair {
  explicit Pair(bool localize, const std::optional<V2vLinkOptions>& v2v = {})
      : simulation(world, device(), {.actors = {leader(localize), follower()}, .v2v = v2v}) {
    for (int tick = 0; tick <= 100; ++tick) reports = simulation.step().reports;
  }
  static Actor leader(bool localize) {
    return patrol({{"points", std::vector{50.0, 0.0}}, {"speed", 0.1}, {"localize", localize}});
  }
  static Actor follower() {
    return patrol({{"points", std::vector{50.0, 0.0}}, {"speed", 0.3}, {"keep", 1.0}, {"localize", false}});
  }
  static Actor patrol(std::vector<control::Setting> settings) {
    return {.controller = {"patrol", 0.0, {"controller 'patrol'", std::move(settings)}}, .link = {}};
  }
  double gap() const { return reports[0].X_WM.x - reports[1].X_WM.x; }  ///< [m]

  world::World world = world::read_world(
      "define robot position( size [0.3 0.3 0.1] drive \"diff\" track 0.258 encoder( track 0.258 scale [1.3 1.3] ) )\n"
      "robot( name \"leader\" pose [0 0 0 0] )\nrobot( name \"follower\" pose [-2 0 0 0] )\n",
      {.sensors = sensors::world_file_words()});
  Simulation simulation;
  std::span<const base::Report> reports;
};

TEST(V2v, CarriesTheStateThatARobotEstimates) {
  const Pair truth(false), own(true);
  EXPECT_FALSE(truth.simulation.estimate(0).quality.stated);
  EXPECT_TRUE(own.simulation.estimate(0).quality.stated);
  EXPECT_GT(own.simulation.estimate(0).quality.covariance[0], 0.0f);
  const double ahead = own.simulation.estimate(0).state.X_WM.x - own.reports[0].X_WM.x;
  EXPECT_GT(ahead, 0.2) << "its wheels count too much";
  EXPECT_NEAR(truth.gap() - own.gap(), ahead, 0.1) << "the follower keeps its distance from the estimate";
  EXPECT_NEAR(Pair(true, V2vLinkOptions{}).gap(), own.gap(), 1e-9) << "also by a simulated link";
}

}  // namespace
}  // namespace sf::scenarios
