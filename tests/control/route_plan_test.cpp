// Plans over SimVille's streets, and conflicts of ways.

#include "tests/control/traffic.h"

#include <gtest/gtest.h>

#include <set>

#include "base/error.h"

namespace sf::traffic {
namespace {

// ---- Plans.

struct Planner {
  Streets streets;
  control::LaneCorridors corridors{streets.roads, streets.world, {}};
  control::RoutePlan from(const std::string& lane, double s) const {
    return plan_from(corridors, *locate_on_lane(corridors, on_lane(streets.roads, lane, s)));
  }
};

TEST(RoutePlan, EveryLegBeginsAtTheEndOfThePreviousOne) {
  const Planner p;
  for (const auto& checkpoint : p.streets.roads.checkpoints) {
    control::RoutePlan plan = p.from("7.2", 0.4);
    ASSERT_TRUE(extend(p.corridors, plan, checkpoint)) << checkpoint.id;
    for (std::size_t i = 0; i + 1 < plan.legs.size(); ++i) {
      const auto& a = plan.legs[i];
      const auto& b = plan.legs[i + 1];
      const glm::dvec2 end = point_on(p.corridors.way(a.way), a.to), start = point_on(p.corridors.way(b.way), b.from);
      EXPECT_LT(length(end - start), 1e-6) << checkpoint.id << " leg " << i;
      EXPECT_EQ(b.start, end_of(a));
    }
    const auto& last = plan.legs.back();
    const glm::dvec2 end = point_on(p.corridors.way(last.way), last.to);
    // The way into a spot ends at the robot's origin, with its front at the checkpoint.
    const double off = checkpoint.at.kind == world::PointRef::Kind::spot ? 0.165 : 0.0;
    EXPECT_NEAR(length(end - checkpoint.p), off, 2e-4) << checkpoint.id;  // chords of 4 cm in bends
  }
}

TEST(RoutePlan, FindsTheShortestPath) {
  const Planner p;
  control::RoutePlan plan = p.from("4.1", 2.0);
  ASSERT_TRUE(extend(p.corridors, plan, *find_checkpoint(p.streets.roads, 8)));
  // Straight across the crossing: the rest of 4.1, 1.2 m, then 5.1 to its sixth point.
  const auto& lane = p.streets.roads.lanes[plan.legs.back().way];
  EXPECT_EQ(plan.legs.size(), 3u);
  EXPECT_NEAR(length_of(plan), 0.6 + 1.2 + lane.points[5].s, 0.01);
}

TEST(RoutePlan, ReturnsToTheSameCheckpoint) {
  const Planner p;
  control::RoutePlan plan = p.from("4.1", 0.1);
  const auto& checkpoint = *find_checkpoint(p.streets.roads, 7);
  ASSERT_TRUE(extend(p.corridors, plan, checkpoint));
  const double once = length_of(plan);
  ASSERT_TRUE(extend(p.corridors, plan, checkpoint));
  EXPECT_GT(length_of(plan), once + 5.0);
}

TEST(RoutePlan, AvoidsAGivenWay) {
  const Planner p;
  control::RoutePlan straight = p.from("4.1", 2.0);
  ASSERT_TRUE(extend(p.corridors, straight, *find_checkpoint(p.streets.roads, 8)));
  control::RoutePlan round = p.from("4.1", 2.0);
  ASSERT_TRUE(extend(p.corridors, round, *find_checkpoint(p.streets.roads, 8), straight.legs[1].way));
  EXPECT_GT(length_of(round), length_of(straight) + 1.0);
}

// Boundary: a cut in a lane ends at its next point, on an exit at that exit's end.
TEST(RoutePlan, IsCutAtTheNextPoint) {
  const Planner p;
  control::RoutePlan plan = p.from("4.1", 0.1);
  ASSERT_TRUE(extend(p.corridors, plan, *find_checkpoint(p.streets.roads, 9)));
  const double exit = plan.legs[1].start;
  for (const double s : {0.0, 0.3, exit - 0.1, exit + 0.1}) {
    control::RoutePlan cut = plan;
    cut_after(p.corridors, cut, s);
    EXPECT_GE(length_of(cut), s);
    EXPECT_LT(length_of(cut), s + 1.4);
    ASSERT_TRUE(extend(p.corridors, cut, *find_checkpoint(p.streets.roads, 9)));
    EXPECT_NEAR(length_of(cut), length_of(plan), 1e-9) << s;
  }
}

TEST(StartPoses, AreApartOnLanesAndDependOnTheSeed) {
  const world::RoadNetwork roads = simville();
  const auto poses = control::start_poses(roads, 50, 1, 0.5);
  ASSERT_EQ(poses.size(), 50u);
  for (std::size_t i = 0; i < poses.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) EXPECT_GE(std::hypot(poses[i].x - poses[j].x, poses[i].y - poses[j].y), 0.5);
  // At least half that distance from the ends of a lane: a robot at its very end would be on the next way.
  for (const Pose& pose : poses) {
    double off = HUGE_VAL;
    for (const world::RoadLane& lane : roads.lanes)
      for (double s = 0.25; s <= world::length_of(lane) - 0.25; s += 0.005) {
        const glm::dvec2 p = world::point_at(lane.centre, s);
        off = std::min(off, std::hypot(p.x - pose.x, p.y - pose.y));
      }
    EXPECT_LT(off, 0.006) << pose.x << " " << pose.y;
  }
  EXPECT_EQ(poses[7].x, control::start_poses(roads, 50, 1, 0.5)[7].x);
  EXPECT_NE(poses[7].x, control::start_poses(roads, 50, 2, 0.5)[7].x);
  EXPECT_THROW(control::start_poses(roads, 500, 1, 0.5), base::InputError);
}

TEST(RoutePlan, LaneChangeCostsAMetreMoreThanItsLength) {
  const Planner p;
  int changes = 0;
  for (std::uint32_t node = 0; node < p.streets.roads.index.size(); ++node)
    for (const control::Edge& edge : p.corridors.edges(node)) {
      const control::Way& way = p.corridors.way(edge.ways[0]);
      if (way.kind != control::Way::Kind::change) continue;
      EXPECT_EQ(edge.from_s, 0.0);
      EXPECT_EQ(edge.to_s, way.length);
      EXPECT_EQ(edge.cost, way.length + 1.0);
      ++changes;
    }
  EXPECT_GT(changes, 20);
}

TEST(LaneCorridors, LaneChangesMayBeginAtTheFirstPointOfALane) {
  const Planner p;
  int first = 0;
  for (std::uint32_t row = 0; row < p.streets.roads.lanes.size(); ++row) {
    const world::PointRef from{world::PointRef::Kind::lane, row, 0};
    std::size_t changes = 0;
    for (const control::Edge& edge : p.corridors.edges(p.corridors.node_of(from)))
      changes += p.corridors.way(edge.ways[0]).kind == control::Way::Kind::change ? 1 : 0;
    EXPECT_EQ(changes, lane_changes(p.streets.roads, from).size()) << row;
    first += static_cast<int>(changes);
  }
  EXPECT_GT(first, 0);
}

TEST(LaneCorridors, AreSharedForOneNetworkWorldAndShape) {
  const Streets a, b;
  const auto shared = control::shared_lane_corridors(a.roads, a.world, {});
  EXPECT_EQ(control::shared_lane_corridors(a.roads, a.world, {}), shared);
  EXPECT_NE(control::shared_lane_corridors(b.roads, a.world, {}), shared);
  EXPECT_NE(control::shared_lane_corridors(a.roads, b.world, {}), shared);
  EXPECT_NE(control::shared_lane_corridors(a.roads, a.world, {.radius = 0.2}), shared);
}

// ---- Conflicts: any two points on two ways without a conflict are clear of each other.

/// A zone begins before the first of its conflicts and ends after the last one to end, which for wide robots need not
/// be the last one to begin.
TEST(LaneCorridors, ConflictZonesCoverTheirConflicts) {
  const Streets streets;
  for (const double radius : {0.165, 0.25}) {
    const control::LaneCorridors corridors(streets.roads, streets.world, {radius, radius});
    for (const control::Way& way : corridors.ways())
      for (const control::ConflictZone& conflict_zone : way.conflict_zones)
        for (const control::Conflict& conflict : conflict_zone.conflicts) {
          EXPECT_LT(conflict_zone.hold, conflict.from);
          EXPECT_GE(conflict_zone.end, conflict.to);
        }
  }
}

TEST(LaneCorridors, WaysWithoutConflictsAreClearOfEachOther) {
  const Planner p;
  const auto& ways = p.corridors.ways();
  using Kind = control::Way::Kind;
  int meets = 0;
  for (std::uint32_t a = 0; a < ways.size(); ++a) {
    if (ways[a].kind != Kind::exit || !ways[a].at_end) continue;
    for (std::uint32_t b = 0; b < ways.size(); ++b) {
      if (b == a || ways[b].kind != Kind::exit || !ways[b].at_end || ways[a].from == ways[b].from) continue;
      for (std::size_t i = 0; i < ways[a].points.size(); ++i) {
        for (std::size_t k = 0; k < ways[b].points.size(); ++k) {
          if (length(ways[a].points[i] - ways[b].points[k]) >= 0.34) continue;
          const bool known = std::any_of(
              ways[a].conflict_zones.begin(), ways[a].conflict_zones.end(),
              [&](const control::ConflictZone& conflict_zone) {
                return std::any_of(conflict_zone.conflicts.begin(), conflict_zone.conflicts.end(),
                                   [&](const control::Conflict& m) {
                                     const double s = double(i) * ways[a].step, t = double(k) * ways[b].step;
                                     return m.way == b && m.from <= s && s <= m.to + 1e-9 && m.other_from <= t &&
                                            t <= m.other_to + 1e-9;
                                   });
              });
          // Consecutive ways do not conflict.
          if (ways[a].into == ways[b].from || ways[b].into == ways[a].from) continue;
          EXPECT_TRUE(known) << a << " " << b;
          ++meets;
        }
      }
    }
  }
  EXPECT_GT(meets, 1000);
}

}  // namespace
}  // namespace sf::traffic
