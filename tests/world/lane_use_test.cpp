#include "world/roads/lane_use.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/refusal.h"
#include "tests/units.h"
#include "world/roads/lane_control.h"
#include "world/roads/roads.h"

namespace sf::world {
namespace {

const RoadNetwork& simville() {
  static const RoadNetwork roads = [] {
    std::vector<Warning> warnings;
    return load_roads(SF_SOURCE_DIR "/worlds/simville/simville.rndf", warnings);
  }();
  return roads;
}

RoadNetwork with_use(const std::string& lane, const std::string& use) {
  std::vector<LaneUse> uses(simville().lanes.size());
  uses[lane_named(simville(), lane)] = lane_use_of(use);
  return with_uses(simville(), uses);
}

/// Returns the exits that routes may take from or to a lane, as "1.1.17>2.1.1".
std::set<std::string> exits_of(const RoadNetwork& roads, const std::string& lane) {
  std::set<std::string> exits;
  for (const RoadExit& exit : roads.exits) {
    const std::string from = point_id_text(id_of(roads, exit.from)), to = point_id_text(id_of(roads, exit.to));
    if (exit.open && (from.starts_with(lane + ".") || to.starts_with(lane + "."))) exits.insert(from + ">" + to);
  }
  return exits;
}

TEST(LaneUse, WithoutChangesTheNetworkIsTheSame) {
  const RoadNetwork same = with_uses(simville(), std::vector<LaneUse>(simville().lanes.size()));
  for (const RoadLane& lane : simville().lanes) {
    const std::string name = lane_name(simville(), lane);
    EXPECT_EQ(exits_of(same, name), exits_of(simville(), name));
  }
  EXPECT_EQ(same.stops.size(), simville().stops.size());
}

TEST(LaneUse, NoExitLeadsIntoAClosedLane) {
  const RoadNetwork roads = with_use("3.1", "closed");
  EXPECT_EQ(exits_of(simville(), "3.1"),
            (std::set<std::string>{"2.1.11>3.1.1", "9.1.3>3.1.1", "3.1.11>4.1.1", "3.1.11>12.2.1"}));
  EXPECT_EQ(exits_of(roads, "3.1"), (std::set<std::string>{"3.1.11>4.1.1", "3.1.11>12.2.1"}));
  EXPECT_EQ(roads.exits.size(), simville().exits.size()) << "robots that are on one finish it";
}

TEST(LaneUse, ALaneForTurnsHasNoExitStraightAhead) {
  for (const char* use : {"turn", "left"})
    EXPECT_FALSE(exits_of(with_use("3.1", use), "3.1").contains("3.1.11>4.1.1")) << use;
  EXPECT_TRUE(exits_of(with_use("3.1", "turn"), "3.1").contains("3.1.11>12.2.1"));
  EXPECT_NE(refusal_of([] {
              with_use("3.1", "right");
            }).find("lane 3.1 has no exit at its end that turns right by 45 degrees or more"),
            std::string::npos);
}

/// The inner lane of Main Street runs as its neighbour 1.3 does, from and to the same streets.
TEST(LaneUse, AReversedLaneIsConnectedAsTheLaneNextToIt) {
  const RoadNetwork roads = with_use("1.1", "reversed");
  EXPECT_EQ(exits_of(roads, "1.1"),
            (std::set<std::string>{"1.1.1>5.2.1", "1.1.1>6.1.1", "2.2.11>1.1.17", "12.2.7>1.1.17"}));
  EXPECT_EQ(exits_of(roads, "1.3"), exits_of(simville(), "1.3"));
  const RoadLane& lane = roads.lanes[lane_named(roads, "1.1")];
  const RoadLane& before = simville().lanes[lane_named(simville(), "1.1")];
  EXPECT_EQ(lane.points.front().id, (PointId{1, 1, 17}));
  EXPECT_EQ(lane.points.front().s, 0.0);
  EXPECT_EQ(lane.points.back().s, length_of(lane));
  EXPECT_EQ(lane.left, before.right);
  EXPECT_EQ(lane.left_edge.front(), before.right_edge.back());
  for (std::size_t i = 0; i + 1 < lane.centre.points.size(); ++i) {
    EXPECT_LT(lane.centre.s[i], lane.centre.s[i + 1]);
    EXPECT_GT(dot(lane.centre.tangents[i], lane.centre.points[i + 1] - lane.centre.points[i]), 0.0);
  }
  // Way-points keep their ids and places.
  for (const auto& [id, at] : roads.index) {
    EXPECT_EQ(id_of(roads, at), id);
    EXPECT_EQ(position_of(roads, at), position_of(simville(), *find_point(simville(), id)));
  }
  for (const RoadCheckpoint& checkpoint : roads.checkpoints) EXPECT_EQ(position_of(roads, checkpoint.at), checkpoint.p);
  const auto stop = std::ranges::find_if(roads.stops, [](const StopLine& line) {
    return line.lights == PointId{1, 3, 17} && line.at.row == 0;
  });
  ASSERT_NE(stop, roads.stops.end()) << "governed as its neighbour";
  EXPECT_EQ(id_of(roads, stop->at), (PointId{1, 1, 1}));
}

TEST(LaneUse, BadRequestsAreRefusedWithWhatIsExpected) {
  EXPECT_NE(refusal_of([] { lane_named(simville(), "99.1"); }).find("has no lane '99.1'; expected segment.lane"),
            std::string::npos);
  EXPECT_NE(refusal_of([] { lane_use_of("close"); }).find("did you mean 'closed'"), std::string::npos);
}

base::Report at(const RoadNetwork& roads, const std::string& lane, double s) {
  const glm::dvec2 p = point_at(roads.lanes[lane_named(roads, lane)].centre, s);
  base::Report report;
  report.X_WM = {p.x, p.y, 0.0, 0.0};
  return report;
}

TEST(LaneControl, ALaneIsReversedOnceItHasBeenEmpty) {
  LaneControl lanes(simville());
  const std::uint32_t row = lane_named(simville(), "1.1");
  const std::vector<base::Report> inside{at(simville(), "1.1", 1.0)}, outside{at(simville(), "3.1", 1.0)};
  EXPECT_FALSE(lanes.update(0, inside));
  lanes.request(row, {.reversed = true});
  EXPECT_TRUE(lanes.update(0, inside)) << "closed at once";
  EXPECT_FALSE(lanes.network()->lanes[row].open);
  const auto closed = lanes.network();
  EXPECT_FALSE(lanes.update(10 * kSecond, inside)) << "it waits";
  EXPECT_FALSE(lanes.update(11 * kSecond, outside));
  EXPECT_FALSE(lanes.update(12 * kSecond - 1, outside));
  EXPECT_TRUE(lanes.update(12 * kSecond, outside));
  EXPECT_TRUE(lanes.network()->lanes[row].open);
  EXPECT_EQ(lanes.uses()[row], (LaneUse{.reversed = true}));
  EXPECT_FALSE(closed->lanes[row].open) << "networks do not change";
  EXPECT_FALSE(lanes.update(20 * kSecond, inside));
  lanes.request(row, {});
  EXPECT_TRUE(lanes.update(20 * kSecond, outside));
  EXPECT_TRUE(lanes.update(22 * kSecond, outside));
  EXPECT_EQ(exits_of(*lanes.network(), "1.1"), exits_of(simville(), "1.1"));
}

/// A request that is withdrawn while the lane is being cleared opens it at once.
TEST(LaneControl, AWithdrawnReversalOpensTheLane) {
  LaneControl lanes(simville());
  const std::uint32_t row = lane_named(simville(), "1.1");
  lanes.request(row, {.reversed = true});
  EXPECT_TRUE(lanes.update(0, {}));
  lanes.request(row, {});
  EXPECT_TRUE(lanes.update(kSecond, {}));
  EXPECT_TRUE(lanes.network()->lanes[row].open);
  EXPECT_FALSE(lanes.update(10 * kSecond, {}));
}

/// Refused requests change nothing.
TEST(LaneControl, ARefusedUseLeavesTheOthers) {
  LaneControl lanes(simville());
  lanes.request(lane_named(simville(), "3.1"), lane_use_of("closed"));
  EXPECT_NE(refusal_of([&] { lanes.request(lane_named(simville(), "3.1"), lane_use_of("right")); }), "");
  EXPECT_TRUE(lanes.update(0, {}));
  EXPECT_EQ(lane_use_name(lanes.uses()[lane_named(simville(), "3.1")]), "closed");
}

}  // namespace
}  // namespace sf::world
