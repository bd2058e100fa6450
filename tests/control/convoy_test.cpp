// Convoys, merging, overtaking, parking.

#include "tests/control/traffic.h"

#include <gtest/gtest.h>

#include <set>

#include "control/overtaking.h"
#include "tests/refusal.h"

namespace sf::traffic {
namespace {

// ---- Parking.

TEST(Parking, StopsWithItsFrontAtTheEndOfEverySpot) {
  for (std::uint32_t spot = 0; spot < 6; ++spot) {
    Streets t;
    t.add(on_lane(t.roads, "10.2", 0.3), "route", {{"park", "13." + std::to_string(spot + 1), ""}});
    t.begin();
    bool docking = false;
    for (int i = 0; i < 1200 && !t.controllers[0]->done(); ++i) {
      t.tick();
      docking = docking || t.intents[0].docking;
    }
    ASSERT_TRUE(t.controllers[0]->done()) << spot;
    EXPECT_TRUE(docking);
    const world::RoadSpot& s = t.roads.spots[spot];
    const glm::dvec2 d = s.end - s.entry;
    const Pose& X = t.pose(0);
    EXPECT_LT(length(t.front(0) - s.end), 0.02) << spot;
    EXPECT_LT(std::abs(base::wrap_angle(X.yaw - std::atan2(d.y, d.x))), 3.0 * M_PI / 180) << spot;
    EXPECT_EQ(t.contacts, 0);
  }
}

/// Rejected before any work: lines for such a small body have billions of points. 0.02 m is a tenth of a Create's
/// radius.
TEST(LaneCorridors, RejectsBodiesTooSmallForTheirRoads) {
  Streets t;
  for (const double radius : {1e-9, 1e-5, 5e-324})
    expect_in("is too small for these roads",
              refusal_of([&] { const control::LaneCorridors corridors(t.roads, t.world, {.radius = radius}); }));
  EXPECT_NO_THROW(control::LaneCorridors(t.roads, t.world, {.radius = 0.02}));
}

/// Boundary: half a radius outside the zone, all along its perimeter.
TEST(Parking, ZoneExtendsByHalfARadius) {
  Streets t;
  const control::LaneCorridors corridors(t.roads, t.world, {.radius = 0.2});
  const control::LaneCorridors narrow(t.roads, t.world, {.radius = 0.02});
  const auto& perimeter = t.roads.zones[0].perimeter;
  for (std::size_t i = 0, j = perimeter.size() - 1; i < perimeter.size(); j = i++) {
    const glm::dvec2 middle = 0.5 * (perimeter[i].p + perimeter[j].p),
                     along = normalize(perimeter[i].p - perimeter[j].p);
    glm::dvec2 out{along.y, -along.x};
    if (narrow.inside(0, middle + 0.02 * out)) out = -out;
    EXPECT_TRUE(corridors.inside(0, middle + 0.099 * out)) << i;
    EXPECT_FALSE(corridors.inside(0, middle + 0.101 * out)) << i;
  }
}

// Five robots leave their spots while a sixth arrives. They take turns, although all start at once.
TEST(Parking, FullCarParkEmptiesWhileAnotherRobotArrives) {
  Streets t;
  const control::LaneCorridors corridors(t.roads, t.world, {});
  for (std::uint32_t spot = 0; spot < 5; ++spot)
    t.add(corridors.parked(spot), "route", go({8, 9.0 + spot % 2}, {{"loop", true, ""}}));
  t.add(on_lane(t.roads, "10.2", 0.3), "route", {{"park", std::string("13.6"), ""}});
  t.begin();
  for (int i = 0; i < 3000; ++i) {
    t.tick();
    int driving = 0;
    for (std::uint32_t row = 0; row < 6; ++row) {
      const glm::dvec2 p{t.pose(row).x, t.pose(row).y};
      const bool parked = control::spot_at(corridors, t.pose(row)).has_value();
      driving += corridors.inside(0, p) && !parked;
    }
    ASSERT_LE(driving, 1) << 0.1 * i;
  }
  EXPECT_TRUE(t.controllers[5]->done());
  for (std::uint32_t row = 0; row < 5; ++row) EXPECT_GT(t.route(row).reached(), 2u) << row;
  EXPECT_EQ(t.contacts, 0);
}

// ---- Convoys.

TEST(Convoy, ChainOfFiveKeepsItsGaps) {
  Streets t;
  for (int k = 0; k < 5; ++k) {
    const Pose X_WM = on_lane(t.roads, "1.1", 4.0 - 0.6 * k);
    if (k == 0) t.add(X_WM, "route", go({6, 7, 8, 2}, {{"loop", true, ""}}));
    if (k > 0) t.add(X_WM, "convoy", {{"leader", double(k), ""}});
  }
  t.begin();
  double longest = 0.0, least = 9.0, farthest = 0.0;
  for (int i = 0; i < 3000; ++i) {
    t.tick();
    for (std::uint32_t k = 1; k < 5; ++k) {
      EXPECT_EQ(t.intents[k].follows, k);
      least = std::min(least, t.distance(k, k - 1));
      farthest = std::max(farthest, t.distance(k, k - 1));
    }
    longest = std::max(longest, t.distance(0, 4));
  }
  EXPECT_EQ(t.contacts, 0);
  EXPECT_GT(t.route(0).reached(), 6u);
  EXPECT_GT(least, 0.4);
  // a stop sign may hold a follower when its leader has just left
  EXPECT_LT(farthest, 2.5);
}

// Positions along the path of the first leader, which determine the order of a convoy.
struct Trail {
  std::vector<glm::dvec2> points;
  void add(const Pose& X) { points.push_back({X.x, X.y}); }
  std::size_t nearest(const Pose& X) const {
    std::size_t best = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (length(points[i] - glm::dvec2{X.x, X.y}) <= length(points[best] - glm::dvec2{X.x, X.y})) best = i;
    return best;
  }
};

/// Robot 4 merges behind robot 1, which robots 2 and 3 follow in a chain.
void expect_merging(const std::string& lane, double front, const std::string& merging_lane, double at,
                    const std::vector<Setting>& leader, std::vector<Setting> merging, int ticks) {
  Streets t;
  t.add(on_lane(t.roads, lane, front), "route", leader);
  for (int k = 1; k < 3; ++k) t.add(on_lane(t.roads, lane, front - 0.6 * k), "convoy", {{"leader", double(k), ""}});
  merging.push_back({"merge_behind", 1.0, ""});
  t.add(on_lane(t.roads, merging_lane, at), "route", std::move(merging));
  t.begin();
  Trail trail;
  for (int i = 0; i < ticks; ++i) {
    t.tick();
    trail.add(t.pose(0));
  }
  EXPECT_EQ(t.contacts, 0);
  EXPECT_EQ(t.intents[3].follows, 1u);
  EXPECT_EQ(t.intents[1].follows, 4u);  // it followed 1 until 4 had merged
  EXPECT_EQ(t.intents[2].follows, 2u);
  EXPECT_GT(trail.nearest(t.pose(3)), trail.nearest(t.pose(1)));
  EXPECT_GT(trail.nearest(t.pose(1)), trail.nearest(t.pose(2)));
}

TEST(Convoy, LetsARobotMergeFromAStopSign) { expect_merging("2.2", 2.2, "12.2", 3.5, go({4, 8}), go({4, 8}), 420); }

TEST(Convoy, LetsARobotMergeFromTheAdjacentLane) {
  expect_merging("1.1", 2.0, "1.2", 2.2, go({2, 5}, {{"speed", 0.15, ""}}), go({2, 5}), 500);
}

/// Distances from which room is made for a newcomer, and from which a follower counts as behind, in both directions of
/// the world.
TEST(Convoy, AppliesItsDistanceLimits) {
  Streets t;
  const control::LaneCorridors corridors(t.roads, t.world, {.radius = 0.2});
  const auto others_at = [](glm::dvec2 d, std::uint32_t follows) {
    std::vector<control::RoadUser> users(3);
    users[0].id = 10, users[1].id = 11, users[2].id = 12;
    users[0].X_WM = {5.0, -3.0, 0.0, 0.0}, users[1].X_WM = users[0].X_WM;
    users[2].X_WM = {5.0 + d.x, -3.0 + d.y, 0.0, 0.0}, users[2].follows = follows;
    return users;
  };
  for (const glm::dvec2& out : {glm::dvec2{1, 0}, {0, 1}, {-1, 0}, {0, -1}, {0.6, 0.8}}) {
    const auto gap = [&](double distance, bool merges = false, std::uint32_t leader = 11) {
      return opened_gap({leader, merges}, corridors, others_at(distance * out, 11));
    };
    EXPECT_DOUBLE_EQ(gap(2.49), 0.7) << "two radii and 0.3 m";
    EXPECT_EQ(gap(2.51), 0.0);
    EXPECT_EQ(gap(1.0, true), 0.0) << "it merges itself";
    EXPECT_EQ(gap(1.0, false, 12), 0.0) << "follows another";
    EXPECT_EQ(gap(1.0, false, base::kNoId), 0.0);
    EXPECT_FALSE(control::follower_lags(others_at(1.19 * out, 10)));
    EXPECT_TRUE(control::follower_lags(others_at(1.21 * out, 10)));
    EXPECT_FALSE(control::follower_lags(others_at(1.21 * out, 11))) << "another's follower";
  }
  EXPECT_EQ(control::row_of(others_at({}, 0), 11), 1u);
  EXPECT_EQ(control::row_of(others_at({}, 0), 12), 2u);
  EXPECT_EQ(control::row_of(others_at({}, 0), 10), std::nullopt) << "the robot itself";
}

// It reaches its last goal at the place where it has just merged; that goal no longer applies.
TEST(Convoy, MergedRobotDropsItsGoals) {
  Streets t;
  t.add(on_lane(t.roads, "1.1", 4.0), "route", go({2}, {{"merge_behind", 2.0, ""}}));
  t.begin();
  const double goal = t.roads.lanes[0].points[12].s;  // 1.1.13
  const auto step = [&](double own, double leader) {
    const control::Neighbour other{2, {.X_WM = on_lane(t.roads, "1.1", leader), .velocity = {0.2, 0, 0}}, {}};
    const base::Report self{.X_WM = on_lane(t.roads, "1.1", own), .velocity = {0.2, 0, 0}};
    t.controllers[0]->step({.time = t.time += kTick, .state = self, .readings = {}, .others = {&other, 1}});
  };
  step(goal - 0.3, goal + 0.2);
  EXPECT_EQ(t.controllers[0]->intent().checkpoint, 2u);
  step(goal + 0.01, goal + 0.9);
  EXPECT_EQ(t.controllers[0]->intent().checkpoint, base::kNoId);
}

// ---- Passing.

TEST(Passing, OvertakesASlowerRobotAndReturns) {
  Streets t;
  t.add(on_lane(t.roads, "1.1", 2.4), "route", go({5}, {{"speed", 0.03, ""}}));
  t.add(on_lane(t.roads, "1.1", 1.2), "route", go({5}));
  t.begin();
  const control::LaneCorridors corridors(t.roads, t.world, {});
  bool passing = false, back = false;
  for (int i = 0; i < 400; ++i) {
    t.tick();
    const auto place = locate_on_lane(corridors, t.pose(1));
    if (!place || place->offset > 0.02) continue;
    const std::string lane = lane_name(t.roads, t.roads.lanes[place->way]);
    passing = passing || lane == "1.2";
    back = back || (passing && lane == "1.1" && t.pose(1).x > t.pose(0).x + 0.4);
  }
  EXPECT_TRUE(passing);
  EXPECT_TRUE(back);
  EXPECT_EQ(t.contacts, 0);
}

// With robots on the other lane, one alongside and one approaching from behind at the same speed, it keeps its lane.
TEST(Passing, WaitsUntilTheOtherLaneIsFree) {
  Streets t;
  t.add(on_lane(t.roads, "1.1", 2.4), "route", go({5}, {{"speed", 0.03, ""}}));
  t.add(on_lane(t.roads, "1.1", 1.6), "route", go({5}));
  t.add(on_lane(t.roads, "1.2", 2.4), "route", go({5}, {{"speed", 0.03, ""}, {"pass", false, ""}}));
  t.begin();
  const control::LaneCorridors corridors(t.roads, t.world, {});
  for (int i = 0; i < 200; ++i) {
    t.tick();
    const auto place = locate_on_lane(corridors, t.pose(1));
    ASSERT_TRUE(place.has_value());
    ASSERT_EQ(lane_name(t.roads, t.roads.lanes[place->way]), "1.1") << 0.1 * i;
    ASSERT_LT(place->offset, 0.02) << 0.1 * i;
  }
  EXPECT_EQ(t.contacts, 0);
}

// A robot on the other lane counts at its position in 3 s. Boundary: a millimetre.
TEST(Passing, WaitsForARobotApproachingFromBehind) {
  const Streets t;
  const control::LaneCorridors corridors(t.roads, t.world, {});
  const auto lane = locate_on_lane(corridors, on_lane(t.roads, "1.1", 1.2));
  const auto other_lane = locate_on_lane(corridors, on_lane(t.roads, "1.2", 1.2));
  ASSERT_TRUE(lane && other_lane);
  const double end = corridors.way(lane->way).length;
  const control::RoutePlan plan{.legs = {{lane->way, 0.0, end, 0.0}, {lane->way, end, end, end}}};
  const control::LeadRobot slow{.free = 0.5, .speed = 0.03, .row = 1};
  std::vector<control::RoadUser> road_users(1);
  const auto leaves = [&] {
    const auto passing = plan_passing(corridors, plan, 1.2, 0.2, slow, road_users);
    return passing ? passing->plan.legs[0].to : end;
  };
  const double free = leaves();
  ASSERT_LT(free, end);
  const double kept = free - 2.0 * corridors.body().radius - 0.3;  // [m] along the lane, to be free before the change
  road_users.push_back({.speed = 0.2});
  road_users[1].positions.count = 1;
  road_users[1].positions.all[0] = {other_lane->way, kept - 0.6 - 0.001, 0.0};
  EXPECT_EQ(leaves(), free);
  road_users[1].positions.all[0].s = kept - 0.6 + 0.001;
  EXPECT_GT(leaves(), free);
}

// Boundary: `pass false` never changes lanes.
TEST(Passing, NeverOvertakesWithPassFalse) {
  Streets t;
  t.add(on_lane(t.roads, "1.1", 2.4), "route", go({5}, {{"speed", 0.03, ""}}));
  t.add(on_lane(t.roads, "1.1", 1.2), "route", go({5}, {{"pass", false, ""}}));
  t.begin();
  for (int i = 0; i < 300; ++i) t.tick();
  EXPECT_LT(t.pose(1).x, t.pose(0).x);
  EXPECT_EQ(t.contacts, 0);
}

/// Returns the time [s] until a robot that stopped when it began to change lanes takes another route; 99: not within 20
/// s.
double gives_up_after(std::uint32_t row, const std::vector<Setting>& more = {}) {
  Streets t;
  for (std::uint32_t k = 0; k < row; ++k) t.add(on_lane(t.roads, "1.3", 1.0 + 0.6 * k), "route", go({8}));
  t.add(on_lane(t.roads, "1.1", 2.0), "route", go({3}, more));
  t.begin();
  for (std::uint32_t k = 0; k < row; ++k) t.controllers[k] = std::make_unique<Idle>();
  const control::LaneCorridors corridors(t.roads, t.world, {});
  const auto changes = [&] {
    const control::RoutePlan& plan = t.route(row).plan();
    return !plan.legs.empty() && changes_lanes(corridors, plan.legs[leg_at(plan, t.route(row).s())].way);
  };
  while (!changes() && t.time < 60 * base::kSecond) t.tick();
  const std::int64_t since = t.time - kTick;  // it was moving when it last decided
  const base::Report still{.X_WM = t.pose(row)};
  for (; t.time <= since + 20 * base::kSecond; t.time += kTick) {
    t.controllers[row]->step({.time = t.time, .state = still, .readings = {}, .others = {}});
    EXPECT_EQ(t.controllers[row]->intent().checkpoint, 3u) << "its goal stays";
    if (!changes()) return 1e-9 * static_cast<double>(t.time - since);
  }
  return 99.0;
}

// Two robots that block each other's lane change wait for different times, unless they are five rows apart.
TEST(Passing, AbortsALaneChangeAfterEightToSixteenSecondsAtRest) {
  const double seconds[] = {8.0, 10.0, 12.0, 14.0, 16.0, 8.0};
  for (std::uint32_t row = 0; row < 6; ++row) EXPECT_NEAR(gives_up_after(row), seconds[row], 1e-6) << row;
  EXPECT_EQ(gives_up_after(0, {{"merge_behind", 77.0, ""}}), 99.0) << "it waits for the gap";
}

}  // namespace
}  // namespace sf::traffic
