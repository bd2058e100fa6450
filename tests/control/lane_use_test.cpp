// Robots on SimVille's streets while the uses of lanes change.

#include <gtest/gtest.h>

#include <set>

#include "tests/control/traffic.h"

namespace sf::traffic {
namespace {

constexpr std::int64_t kLongest = 400 * kSecond;

/// Returns the lanes that the robot was on until it is done.
std::set<std::string> lanes_until_done(Streets& t, std::uint32_t row) {
  std::set<std::string> lanes;
  while (!t.controllers[row]->done() && t.time < kLongest) {
    t.tick();
    const auto& plan = t.route(row).plan();
    const std::uint32_t way = plan.legs[leg_at(plan, t.route(row).s())].way;
    if (way < t.roads.lanes.size()) lanes.insert(lane_name(t.roads, t.roads.lanes[way]));
  }
  EXPECT_TRUE(t.controllers[row]->done()) << t.route(row).stop_reason();
  return lanes;
}

/// One robot is in the lane when it closes and drives on; the one behind takes another way to the same checkpoint.
TEST(LaneUse, AClosedLaneIsLeftAndAvoided) {
  for (const bool closes : {false, true}) {
    Streets t;
    t.add(on_lane(t.roads, "3.1", 0.5), "route", go({7, 8, 2}, {{"loop", true, ""}}));
    t.add(on_lane(t.roads, "2.1", 0.5), "route", go({7, 8}));
    t.begin();
    for (int i = 0; i < 10; ++i) t.tick();
    if (closes) t.use("3.1", "closed");
    EXPECT_EQ(lanes_until_done(t, 1).contains("3.1"), !closes);
    EXPECT_GE(t.route(0).reached(), 2u);
    EXPECT_EQ(t.contacts, 0);
  }
}

/// A robot so near to the end of its lane that it cannot stop enters the closed lane.
TEST(LaneUse, ARobotThatCannotStopEnters) {
  Streets t;
  t.add(on_lane(t.roads, "2.1", 1.0), "route", go({7}));
  t.begin();
  const double end = length_of(t.roads.lanes[lane_named(t.roads, "2.1")]);
  while (t.route(0).s() < end - 1.0 - 0.03) t.tick();
  t.use("3.1", "closed");
  EXPECT_TRUE(lanes_until_done(t, 0).contains("3.1"));
}

TEST(LaneUse, ALaneForTurnsChangesTheRoute) {
  Streets t;
  t.add(on_lane(t.roads, "3.1", 0.5), "route", go({7}));
  t.begin();
  t.tick();
  t.use("3.1", "turn");
  EXPECT_TRUE(lanes_until_done(t, 0).contains("12.2"));
  EXPECT_EQ(t.contacts, 0);
}

/// Without a way to its checkpoint the robot waits where its route ends, and continues once the lane opens.
TEST(LaneUse, ARobotWaitsWhileNoLaneLeadsToItsCheckpoint) {
  Streets t;
  t.add(on_lane(t.roads, "2.1", 0.5), "route", go({6}));
  t.begin();
  t.tick();
  t.use("3.1", "closed");  // checkpoint 6 is on it
  for (int i = 0; i < 300; ++i) t.tick();
  EXPECT_EQ(t.route(0).stop_reason(), "no open lane leads to its checkpoint");
  EXPECT_LT(std::abs(t.fleet->reports()[0].velocity.forward), 1e-9);
  EXPECT_FALSE(t.controllers[0]->done());
  t.use("3.1", "open");
  EXPECT_TRUE(lanes_until_done(t, 0).contains("3.1"));
}

/// A robot is in the lane. It leaves before the lane opens in the other direction, to the robot that waits for it: the
/// lane next to it is closed. Checkpoint 1 is in the lane, whichever way it runs.
TEST(LaneUse, AReversedLaneIsDrivenTheOtherWayOnceItIsEmpty) {
  Streets t;
  t.add(on_lane(t.roads, "1.1", 1.0), "route", go({2, 5}));
  t.add(on_lane(t.roads, "2.2", 0.5), "route", go({1, 8}));
  t.begin();
  t.tick();
  t.use("1.3", "closed");
  t.use("1.1", "reversed");
  const std::uint32_t row = lane_named(t.roads, "1.1");
  bool together = false;
  while (t.lanes->is_clearing(row) || t.time < kSecond) {
    t.tick();
    ASSERT_LT(t.time, kLongest);
    const auto& plan = t.route(1).plan();
    together = together || plan.legs[leg_at(plan, t.route(1).s())].way == row;
  }
  EXPECT_FALSE(together) << "it does not enter before";
  EXPECT_GE(t.route(0).reached(), 1u) << "the first robot has left";
  EXPECT_TRUE(lanes_until_done(t, 1).contains("1.1"));
  lanes_until_done(t, 0);
  EXPECT_EQ(t.contacts, 0);
}

/// Lanes change again and again under traffic.
TEST(LaneUse, TrafficHasNoContactsWhileLanesChange) {
  const std::vector<std::pair<std::string, std::string>> changes{
      {"1.1", "reversed"}, {"3.1", "closed"},   {"1.1", "open"},   {"3.1", "turn"},
      {"5.2", "closed"},   {"3.2", "reversed"}, {"5.2", "open"},   {"3.1", "open"},
      {"1.1", "reversed"}, {"3.2", "open"},     {"1.2", "closed"}, {"1.1", "open"}};
  Streets t;
  t.add_lights();
  for (const Pose& pose : control::start_poses(t.roads, 20, 3, 0.8))
    t.add(pose, "route", {{"tour", true, ""}, {"gap", 0.1, ""}});
  t.begin();
  std::size_t reversals = 0;
  for (std::size_t i = 0; i < changes.size(); ++i) {
    t.use(changes[i].first, changes[i].second);
    for (int tick = 0; tick < 200; ++tick) t.tick();
    for (const world::LaneUse& use : t.lanes->uses()) reversals += use.reversed ? 1 : 0;
  }
  EXPECT_EQ(t.contacts, 0);
  EXPECT_GE(reversals, 1u);
  std::uint64_t reached = 0;
  for (std::uint32_t row = 0; row < 20; ++row) reached += t.route(row).reached();
  EXPECT_GE(reached, 40u) << "they drive on";
}

}  // namespace
}  // namespace sf::traffic
