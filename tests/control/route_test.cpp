// Robots on SimVille's streets, alone and one behind another.

#include "tests/control/traffic.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "base/error.h"
#include "tests/refusal.h"

namespace sf::traffic {
namespace {

// ---- A single robot.

TEST(Route, DrivesEveryCheckpointOfSimville) {
  Streets t;
  Numbers all;
  for (const auto& checkpoint : t.roads.checkpoints) all.push_back(checkpoint.id);
  t.add(on_lane(t.roads, "1.1", 0.3), "route", go(all));
  t.begin();
  double worst = 0.0, last = 0.0;  // [m], [m/s] when it decides
  std::set<std::uint32_t> headed;
  while (!t.controllers[0]->done() && t.time < 3'000'000'000'000) {
    last = t.fleet->reports()[0].velocity.forward;
    t.tick();
    worst = std::max(worst, std::abs(t.controllers[0]->error()));
    headed.insert(t.intents[0].checkpoint);
  }
  EXPECT_TRUE(t.controllers[0]->done()) << "reached " << t.route(0).reached();
  EXPECT_EQ(t.route(0).reached(), all.size());
  for (const double id : all) EXPECT_TRUE(headed.count(std::uint32_t(id))) << id;
  EXPECT_LT(worst, 0.02);  // [m] from its line
  EXPECT_LT(std::abs(last), 0.01) << "done only at rest";
  EXPECT_EQ(t.contacts, 0);
}

/// Without the start signal it neither drives nor broadcasts its goal.
TEST(Route, WaitsForTheStartSignal) {
  Streets t;
  t.add(on_lane(t.roads, "1.1", 0.3), "route", go({1}));
  t.begin();
  for (const std::int64_t time : {std::int64_t{0}, std::int64_t{100'000'000}, std::int64_t{5'000'000'000}}) {
    const Twist command =
        t.controllers[0]->step({.time = time, .state = t.fleet->reports()[0], .readings = {}, .started = false});
    EXPECT_EQ(command.forward, 0.0);
    EXPECT_EQ(command.turn, 0.0);
    EXPECT_EQ(t.controllers[0]->intent().checkpoint, base::kNoId);
    EXPECT_EQ(t.route(0).stop_reason(), "the start signal has not arrived");
  }
  t.time = 5'100'000'000;
  t.tick();
  t.tick();
  EXPECT_GT(t.fleet->reports()[0].velocity.forward, 0.0);
  EXPECT_EQ(t.controllers[0]->intent().checkpoint, 1u);
}

TEST(Route, RepeatsAMission) {
  Streets t;
  t.add(on_lane(t.roads, "1.1", 0.3), "route",
        {{"mission", std::string(SF_SOURCE_DIR "/worlds/simville/simville.mdf"), ""}, {"loop", true, ""}});
  t.begin();
  while (t.route(0).reached() < 20 && t.time < 2'000'000'000'000) t.tick();
  EXPECT_GE(t.route(0).reached(), 20u);
  EXPECT_FALSE(t.controllers[0]->done());
}

// 5 mph are 0.319 m/s at scale 1/7; 8 mph are 0.511 m/s, above the robot's own speed.
TEST(Route, KeepsTheMissionsSpeedLimitsAndSlowsDownInBends) {
  Streets t;
  t.add(on_lane(t.roads, "1.1", 0.3), "route",
        {{"mission", std::string(SF_SOURCE_DIR "/worlds/simville/simville.mdf"), ""}, {"speed", 0.45, ""}});
  t.begin();
  std::map<int, double> fastest;  // by segment
  double sideways = 0.0;          // [m/s^2]
  while (!t.controllers[0]->done() && t.time < 600'000'000'000) {
    t.tick();
    const control::RoutePlan& plan = t.route(0).plan();
    const control::RouteLeg& leg = plan.legs[leg_at(plan, t.route(0).s())];
    const Twist& v = t.fleet->reports()[0].velocity;
    if (v.forward > 0.2) sideways = std::max(sideways, std::abs(v.forward * v.turn));
    if (leg.way >= t.roads.lanes.size() || t.route(0).s() - leg.start < 0.1) continue;
    double& most = fastest[t.roads.segments[t.roads.lanes[leg.way].segment].id];
    most = std::max(most, v.forward);
  }
  EXPECT_TRUE(t.controllers[0]->done());
  EXPECT_NEAR(fastest[1], 0.45, 1e-9) << "its own";
  EXPECT_NEAR(fastest[3], 5.0 * 0.44704 / 7.0, 1e-6) << "the mission's";
  EXPECT_LT(sideways, 0.15) << "0.1 m/s^2 where the bend is even";
  EXPECT_GT(sideways, 0.08);
}

TEST(Route, ParksAtHalfItsSpeed) {
  Streets t;
  t.add(on_lane(t.roads, "1.1", 0.3), "route", {{"park", std::string("13.4"), ""}});
  t.begin();
  double fastest = 0.0, near = 0.0;  // [m/s], overall and within 0.6 m of the spot
  while (!t.controllers[0]->done() && t.time < 600'000'000'000) {
    t.tick();
    const double speed = std::abs(t.fleet->reports()[0].velocity.forward);
    fastest = std::max(fastest, speed);
    for (const world::RoadSpot& spot : t.roads.spots)
      if (spot.number == 4 && length(glm::dvec2{t.pose(0).x, t.pose(0).y} - spot.end) < 0.6)
        near = std::max(near, speed);
  }
  EXPECT_TRUE(t.controllers[0]->done());
  EXPECT_NEAR(fastest, 0.2, 1e-9);
  EXPECT_NEAR(near, 0.1, 0.01);
}

// The third spot is parallel to the x axis, so that the way out of it from (0, 0) is measured exactly; the first turn
// belongs to the first spot.
TEST(Route, WaitsForItsTurnToLeaveItsSpot) {
  Streets t;
  ASSERT_GT(t.roads.zones[0].spots, 2u);
  world::RoadSpot& spot = t.roads.spots[t.roads.zones[0].first_spot + 2];
  spot.entry = {-1.0, 0.0};
  t.add({}, "route", go({8}));
  const control::RoadFootprint body = control::footprint_of(t.world.movers[0]);
  spot.end = {body.front, 0.0};
  t.begin();
  const auto step = [&](double x) { return t.controllers[0]->step({.time = 0, .state = {.X_WM = {x, 0, 0, 0}}}); };
  step(0.0);
  const double margin = 0.12 * body.radius;
  EXPECT_EQ(step(-0.99 * margin).forward, 0.0);
  EXPECT_EQ(t.route(0).stop_reason(), "it waits for its turn to leave its parking spot");
  EXPECT_LT(step(-margin).forward, 0.0) << "in reverse";
  EXPECT_EQ(t.route(0).s(), margin);
  EXPECT_EQ(t.route(0).stop_reason(), "");
}

// 6.2.3 and 1.3.17 are stop signs. The robot stops at each, with its front within 5 cm of the line.
TEST(Route, StopsFullyAtEveryStopSign) {
  Streets t;
  t.add(on_lane(t.roads, "1.3", 0.3), "route", go({8, 4, 8, 4, 9, 8}));
  t.begin();
  int crossed = 0;
  bool stopped = false;
  glm::dvec2 last = t.front(0);
  while (!t.controllers[0]->done() && t.time < 1'500'000'000'000) {
    t.tick();
    const glm::dvec2 front = t.front(0);
    for (const world::StopLine& stop : t.roads.stops) {
      const glm::dvec2 middle = 0.5 * (stop.left + stop.right), across = stop.left - stop.right;
      const glm::dvec2 along{across.y, -across.x};
      const double before = dot(last - middle, along) / length(along),
                   after = dot(front - middle, along) / length(along);
      if (length(front - middle) > 0.2) continue;
      if (before > -0.05 && before <= 0.0 && t.fleet->reports()[0].velocity.forward == 0.0) stopped = true;
      if (before <= 0.0 && after > 0.0) {
        EXPECT_TRUE(stopped) << "at " << middle.x << " " << middle.y;
        stopped = false;
        ++crossed;
      }
    }
    last = front;
  }
  EXPECT_TRUE(t.controllers[0]->done());
  EXPECT_GE(crossed, 5);
}

// ---- Lights: all states, with the front checked against the line on every tick.

struct LightCase {
  world::LightState state;
  bool crosses;  ///< within a minute
  bool stops;    ///< before
  const char* why;
};

TEST(Route, ObeysEveryStateOfALight) {
  using enum world::LightState;
  for (const LightCase& c :
       {LightCase{red, false, true, "red"}, LightCase{green, true, false, "green"},
        LightCase{yellow, false, true, "permanent yellow, and it can stop"},
        LightCase{flashing_red, true, true, "as a stop sign"},
        LightCase{flashing_yellow, true, false, "passes with care"}, LightCase{dark, true, true, "as a stop sign"}}) {
    Streets t;
    t.world.lights = {light("it", {"6.1.3"}, {{c.state, 1.0}})};
    t.add(on_lane(t.roads, "6.1", 0.2), "route", go({10}));
    t.begin();
    bool crossed = false, stopped = false;
    for (int i = 0; i < 300 && !crossed; ++i) {
      t.tick();
      crossed = t.pose(0).x + 0.165 > 2.8;
      stopped = stopped || t.fleet->reports()[0].velocity.forward == 0.0;
    }
    EXPECT_EQ(crossed, c.crosses) << c.why;
    EXPECT_EQ(stopped, c.stops) << c.why;
    EXPECT_EQ(t.route(0).stop_reason(), c.crosses           ? ""
                                        : c.state == yellow ? "its light is yellow"
                                                            : "its light is red")
        << c.why;
  }
}

TEST(Route, NeverCrossesARedLight) {
  using enum world::LightState;
  int crossings = 0;
  for (int k = 0; k < 24; ++k) {
    Streets t;
    t.world.lights = {light("it", {"6.1.3"}, {{green, 4.0}, {yellow, 1.0}, {red, 5.0}}, 0.41 * k)};
    t.add(on_lane(t.roads, "6.1", 0.2), "route", go({10}));
    t.begin();
    for (int i = 0; i < 250; ++i) {
      const double before = t.pose(0).x + 0.165;
      t.tick();
      if (before > 2.8 || t.pose(0).x + 0.165 <= 2.8) continue;
      EXPECT_NE(t.signals[0].state, red) << "offset " << 0.41 * k;
      ++crossings;
    }
  }
  EXPECT_EQ(crossings, 24);
}

// ---- Refusals.

std::string refusal(const std::vector<Setting>& settings, const Pose& X_WM) {
  Streets t;
  t.add(X_WM, "route", settings);
  return refusal_of([&] { t.begin(), t.tick(); });
}

TEST(Route, RejectsUndrivableRoutes) {
  const Pose lane = on_lane(simville(), "1.1", 1.0);
  expect_in("'checkpoints' names 99", refusal(go({99}), lane));
  expect_in("names 1.5", refusal(go({1.5}), lane));
  expect_in("no destination", refusal({}, lane));
  expect_in("no parking spot '13.9'", refusal({{"park", std::string("13.9"), ""}}, lane));
  expect_in("none.mdf", refusal({{"mission", std::string("none.mdf"), ""}}, lane));
  expect_in("no lane", refusal(go({1}), {5.3, 5.0, 0, 0}));
  expect_in("'speed'", refusal(go({1}, {{"speed", 0.0, ""}}), lane));
  expect_in("'tour'", refusal(go({1}, {{"tour", true, ""}}), lane));
  EXPECT_EQ(refusal(go({1}), lane), "");
}

// A network of one lane with a dead end: the second lap has no path.
TEST(Route, ReportsUnreachableGoals) {
  Streets t;
  t.roads.exits.clear();
  t.add(on_lane(t.roads, "1.1", 1.0), "route", go({4}));
  t.begin();
  expect_in("no route to checkpoint 4 (way-point 1.3.6)", refusal_of([&] { t.tick(); }));
}

// Rejects the route at the start if the third of three checkpoints cannot be reached.
TEST(Route, ChecksTheWholeListBeforeStarting) {
  Streets t;
  const auto row = find_checkpoint(t.roads, 12)->at.row;
  std::erase_if(t.roads.exits, [&](const world::RoadExit& exit) {
    return exit.to.kind == world::PointRef::Kind::lane && exit.to.row == row;
  });
  t.add(on_lane(t.roads, "1.1", 1.0), "route", go({2, 5, 12}));
  t.begin();
  EXPECT_THROW(t.tick(), base::InputError);
}

// Boundary: the robot starts in a crossing, on the way from 2.1 to 3.1.
TEST(Route, StartsBetweenLanes) {
  Streets t;
  t.add({10.25, 3.3, 0.0, M_PI / 2}, "route", go({6}));
  t.begin();
  for (int i = 0; i < 400 && !t.controllers[0]->done(); ++i) t.tick();
  EXPECT_TRUE(t.controllers[0]->done());
}

// ---- Two and more.

TEST(Route, FollowsASlowerRobotWithoutContact) {
  for (const double slow : {0.02, 0.1, 0.19}) {
    Streets t;
    t.add(on_lane(t.roads, "1.3", 2.0), "route", go({8}, {{"speed", slow, ""}}));
    t.add(on_lane(t.roads, "1.3", 0.5), "route", go({8}));
    t.begin();
    double least = 9.0;
    for (int i = 0; i < 300; ++i) {
      t.tick();
      least = std::min(least, t.distance(0, 1));
    }
    EXPECT_EQ(t.contacts, 0) << slow;
    EXPECT_GT(least, 0.36) << slow;  // two radii and a gap
    if (slow < 0.19) {
      EXPECT_NEAR(t.fleet->reports()[1].velocity.forward, slow, 0.01) << slow;
    }
  }
}

// Behind a permanently stopped robot it stops nearby, without contact.
TEST(Route, StopsBehindAStoppedRobot) {
  Streets t;
  t.add(on_lane(t.roads, "4.1", 2.0), "route", go({7}, {{"speed", 0.01, ""}}));
  t.add(on_lane(t.roads, "4.1", 0.5), "route", go({8}));
  t.begin();
  t.controllers[0] = std::make_unique<Idle>();
  for (int i = 0; i < 300; ++i) t.tick();
  EXPECT_EQ(t.fleet->reports()[1].velocity.forward, 0.0);
  EXPECT_GT(t.distance(0, 1), 0.37);
  EXPECT_LT(t.distance(0, 1), 0.5);
  EXPECT_EQ(t.contacts, 0);
  EXPECT_EQ(t.route(1).stop_reason(), "'robot1' blocks its way");
}

TEST(Route, StatesItsStopReasonAtAStopSign) {
  Streets t;
  t.add(on_lane(t.roads, "1.3", 0.3), "route", go({8}));
  t.begin();
  EXPECT_EQ(t.route(0).stop_reason(), "the start signal has not arrived") << "before its first step";
  std::set<std::string> reasons;
  while (!t.controllers[0]->done() && t.time < 1'000'000'000'000) {
    t.tick();
    if (t.fleet->reports()[0].velocity.forward == 0.0) reasons.insert(t.route(0).stop_reason());
  }
  EXPECT_TRUE(reasons.contains("it stops at a stop line"));
  EXPECT_EQ(t.route(0).stop_reason(), "") << "done";
}

}  // namespace
}  // namespace sf::traffic
