// Users of bridges pause, step, reset, drive and place. Nothing here depends on the speed of the machine: a run without
// a speed limit never waits, and a paused one continues on request.

#include "scenarios/operator.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <memory>

#include "tests/device.h"
#include "tests/sensors/scenes.h"

namespace sf::scenarios {
namespace {

/// Two robots in the middle of four walls.
world::World room() {
  world::World world;
  scenes::add_room(world, {0.0, 0.0}, 8.0);
  scenes::add_robot(world, {-1.0, 0.0, 0.0, 0.0}, scenes::laser());
  scenes::add_robot(world, {1.0, 0.0, 0.0, 0.0}, scenes::laser());
  return world;
}

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

/// A bridge whose user makes the test's requests, one set per poll.
struct Script : bridges::Bridge {
  void publish(const base::TickRecord&, const bridges::RunState& state) override { ++ticks, last = state; }
  void publish(const bridges::RunState& state) override { ++looks, last = state; }
  void take(bridges::Requests& requests) override { act(requests); }
  std::string describe() const override { return "script"; }
  void show_intents(std::span<const base::Intent> shown) override { intents.assign(shown.begin(), shown.end()); }

  std::function<void(bridges::Requests&)> act = [](bridges::Requests&) {};
  int ticks = 0, looks = 0;
  std::vector<base::Intent> intents;
  bridges::RunState last;
};

struct OperatorTest : testing::Test {
  OperatorTest() {
    auto made = std::make_unique<Script>();
    script = made.get();
    bridges.add(std::move(made));
  }
  Operator::Next wait() { return users.wait(simulation, 0.1 * static_cast<double>(ticks)); }
  void tick() {
    const base::TickRecord record = simulation.step();
    users.publish(record);
    reports.assign(record.reports.begin(), record.reports.end());
    ++ticks;
  }

  const world::World world = room();
  Simulation simulation{world, device(), {.seed = 1}};
  bridges::Bridges bridges;
  std::atomic<bool> stop{false};
  Script* script = nullptr;
  Operator users{bridges, stop, kNoLimit};
  std::vector<base::Report> reports;  ///< of the last tick
  int ticks = 0;
};

TEST_F(OperatorTest, WithoutRequestsTicksFollow) {
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(wait(), Operator::Next::tick);
    tick();
  }
  EXPECT_EQ(script->ticks, 3);
  EXPECT_EQ(script->looks, 0);
}

TEST_F(OperatorTest, IntentsReachTheBridges) {
  const base::Intent intents[] = {{.checkpoint = 3}, {.follows = 1}};
  users.publish(simulation.step(), intents);
  ASSERT_EQ(script->intents.size(), 2u);
  EXPECT_EQ(script->intents[0].checkpoint, 3u);
  users.publish(simulation.step());
  EXPECT_TRUE(script->intents.empty()) << "unknown";
}

TEST_F(OperatorTest, APausedRunSimulatesRequestedTicks) {
  int asked = 0;
  script->act = [&](bridges::Requests& requests) {
    if (asked == 0) requests.paused = true;
    if (asked == 2) requests.steps = 2;
    if (asked == 6) requests.paused = false;
    ++asked;
  };
  for (int i = 0; i < 2; ++i, tick()) ASSERT_EQ(wait(), Operator::Next::tick);
  EXPECT_TRUE(script->last.paused);
  EXPECT_EQ(script->looks, 2) << "two polls before the steps were requested";
  EXPECT_EQ(wait(), Operator::Next::tick);  // continues
  tick();
  EXPECT_FALSE(script->last.paused);
}

TEST_F(OperatorTest, StepsOfAnUnpausedRunAreIgnored) {
  int asked = 0;
  script->act = [&](bridges::Requests& requests) {
    if (asked == 0) requests.steps = 5;
    if (asked == 1) requests.paused = true;
    if (asked == 4) stop = true;
    ++asked;
  };
  EXPECT_EQ(wait(), Operator::Next::tick);
  EXPECT_EQ(wait(), Operator::Next::stop) << "the steps of before must not count now";
}

TEST_F(OperatorTest, AResetIsAppliedOnce) {
  int asked = 0;
  script->act = [&](bridges::Requests& requests) { requests.reset = asked++ == 1; };
  EXPECT_EQ(wait(), Operator::Next::tick);
  EXPECT_EQ(wait(), Operator::Next::reset);
  users.begin_again();
  EXPECT_EQ(users.resets(), 1u);
  EXPECT_EQ(wait(), Operator::Next::tick);
  tick();
  EXPECT_EQ(script->last.runs, 1u);
}

TEST_F(OperatorTest, AResetOfAPausedRunIsImmediate) {
  script->act = [&](bridges::Requests& requests) {
    requests.paused = true;
    requests.reset = true;
  };
  EXPECT_EQ(wait(), Operator::Next::reset);
}

TEST_F(OperatorTest, StopEndsAllWaiting) {
  stop = true;
  EXPECT_EQ(wait(), Operator::Next::stop);
  Operator slow(bridges, stop, 1e-6);
  EXPECT_EQ(slow.wait(simulation, 1e6), Operator::Next::stop);
  slow.keep_pace(1e6);
}

TEST_F(OperatorTest, ADrivenRobotExecutesItsCommandUntilTheNext) {
  script->act = [&](bridges::Requests& requests) {
    if (ticks == 1) requests.commands.push_back({0, {0.0, 0.0, 0.5}});
    if (ticks == 4) requests.commands.push_back({0, {}});
  };
  double yaw[6] = {};
  for (double& each : yaw) {
    ASSERT_EQ(wait(), Operator::Next::tick);
    tick();
    each = reports[0].X_WM.yaw;
  }
  EXPECT_GT(yaw[2], yaw[1]);
  EXPECT_NEAR(yaw[3] - yaw[2], 0.05, 1e-12) << "half a radian per second, for a tick";
  EXPECT_EQ(yaw[5], yaw[4]) << "a zero command stays in effect; the controller does not step";
}

TEST_F(OperatorTest, PlacedRobotsAreAtTheirNewPose) {
  script->act = [&](bridges::Requests& requests) { requests.placements.push_back({1, {0.5, 0.25, 0.0, 1.0}}); };
  ASSERT_EQ(wait(), Operator::Next::tick);
  tick();
  const base::Pose& X_WM = reports[1].X_WM;
  EXPECT_EQ(X_WM.x, 0.5);
  EXPECT_EQ(X_WM.y, 0.25);
}

TEST_F(OperatorTest, ASpeedAppliesFromThenOn) {
  script->act = [&](bridges::Requests& requests) {
    if (ticks == 0) requests.speed = 2.0;
  };
  ASSERT_EQ(wait(), Operator::Next::tick) << "does not wait for earlier ticks";
  tick();
  EXPECT_EQ(script->last.speed, 2.0);
}

TEST(Operator, WithoutBridgesARunNeverWaits) {
  const world::World world = room();
  Simulation simulation(world, device(), {.seed = 1});
  bridges::Bridges none;
  const std::atomic<bool> stop{false};
  Operator users(none, stop, kNoLimit);
  EXPECT_EQ(users.wait(simulation, 1e9), Operator::Next::tick);
}

bridges::Joining joining(const std::string& name) { return {name, "", {}, std::make_shared<bridges::Outcome>()}; }

/// A run that supports no robots and worlds refuses them, each with a reason.
TEST_F(OperatorTest, RefusesUnsupportedChanges) {
  const bridges::Joining late = joining("late");
  const bridges::Leaving first{0, std::make_shared<bridges::Outcome>()};
  const auto other = std::make_shared<bridges::Outcome>();
  script->act = [&](bridges::Requests& requests) {
    requests.joining = {late};
    requests.leaving = {first};
    requests.world = bridges::WorldChange{"a.world", false, other};
  };
  EXPECT_EQ(wait(), Operator::Next::tick);
  for (const auto& outcome : {late.outcome, first.outcome, other}) {
    EXPECT_TRUE(outcome->done);
    EXPECT_EQ(outcome->fault, bridges::Outcome::Fault::failed);
    EXPECT_NE(outcome->reason, "");
  }
}

/// Each robot that joins takes time: a few join per tick, in order.
TEST_F(OperatorTest, AddsAFewRobotsPerTick) {
  std::vector<std::string> joined;
  users.on_fleet_changes([&](const auto& robots, const auto&) {
    for (const bridges::Joining& each : robots) {
      joined.push_back(each.name);
      each.outcome->done = true;
    }
  });
  script->act = [&](bridges::Requests& requests) {
    for (int k = 0; k < 6; ++k) requests.joining.push_back(joining(std::to_string(k)));
    script->act = [](bridges::Requests&) {};
  };
  EXPECT_EQ(wait(), Operator::Next::tick);
  EXPECT_EQ(joined, (std::vector<std::string>{"0", "1", "2", "3"}));
  EXPECT_EQ(wait(), Operator::Next::tick);
  EXPECT_EQ(joined.size(), 6u);
}

TEST_F(OperatorTest, ReturnsTheWorldThatAUserRequested) {
  users.set_loads_worlds(true);
  script->act = [&](bridges::Requests& requests) {
    requests.world = bridges::WorldChange{"a.world", true, std::make_shared<bridges::Outcome>()};
    script->act = [](bridges::Requests&) {};
  };
  EXPECT_EQ(wait(), Operator::Next::world);
  EXPECT_EQ(users.take_world().file, "a.world");
  EXPECT_EQ(wait(), Operator::Next::tick);
}

/// Six of ten steps of a paused run are dropped after the first one.
TEST_F(OperatorTest, DropsSteps) {
  script->act = [&](bridges::Requests& requests) {
    requests.paused = true;
    requests.steps = 10;
    script->act = [&](bridges::Requests& later) {
      later.dropped_steps = 6;
      script->act = [](bridges::Requests&) {};
    };
  };
  int made = 0;
  for (; made < 4; ++made) EXPECT_EQ(wait(), Operator::Next::tick);
  script->act = [&](bridges::Requests&) { stop = true; };
  EXPECT_EQ(wait(), Operator::Next::stop);
}

}  // namespace
}  // namespace sf::scenarios
