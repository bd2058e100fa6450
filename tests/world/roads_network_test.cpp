// Networks in metres: positions, widths, edges and transitions.

#include "world/roads/network.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "tests/world/rndf_text.h"
#include "tests/world/successors.h"
#include "world/roads/lane_markings.h"
#include "world/roads/roads.h"

namespace sf::world {
namespace {

constexpr double kLatitude = 111034.6326;  // [m] of a degree of latitude at 40 degrees north
constexpr double kLongitude = 85393.7868;  // [m] of a degree of longitude there

RoadNetwork build(const std::string& rndf, const std::string& sidecar = "") {
  std::vector<Warning> warnings;
  return build_network(parse_rndf("small.rndf", rndf), parse_sidecar("small.toml", sidecar, warnings), warnings);
}
RoadNetwork small(const std::string& sidecar = "") { return build(std::string(kSmallRndf), sidecar); }

glm::dvec2 at(const RoadNetwork& network, PointId id) { return position_of(network, *find_point(network, id)); }

TEST(RoadNetwork, PositionsAreMetresFromTheFirstPoint) {
  const RoadNetwork network = small();
  EXPECT_EQ(at(network, {1, 1, 1}).x, 0.0);
  EXPECT_NEAR(at(network, {1, 1, 3}).x, 0.002 * kLongitude, 1e-3);
  EXPECT_NEAR(at(network, {2, 1, 2}).y, 0.001 * kLatitude, 5e-3);  // parallels curve: 2 mm in 180 m
  EXPECT_NEAR(length_of(network.lanes[0]), 0.002 * kLongitude, 1e-3);
  EXPECT_EQ(network.lanes[0].points[2].s, length_of(network.lanes[0]));
  EXPECT_NEAR(network.lanes[0].points[1].yaw, 0.0, 1e-4);             // east
  EXPECT_NEAR(std::abs(network.lanes[1].points[0].yaw), M_PI, 1e-4);  // west
}

TEST(RoadNetwork, SidecarPlacesScalesAndTurns) {
  const RoadNetwork network = small("scale = 0.5\nposition = [100, 200]\nheading_deg = 90");
  EXPECT_EQ(at(network, {1, 1, 1}).x, 100.0);
  EXPECT_EQ(at(network, {1, 1, 1}).y, 200.0);
  EXPECT_NEAR(at(network, {1, 1, 3}).x, 100.0, 1e-3);  // east became north
  EXPECT_NEAR(at(network, {1, 1, 3}).y, 200.0 + 0.001 * kLongitude, 1e-3);
  EXPECT_NEAR(at(network, {2, 1, 2}).x, 100.0 - 0.0005 * kLatitude, 5e-3);
  EXPECT_NEAR(network.lanes[0].width, 12 * 0.3048 * 0.5, 1e-12);  // feet are scaled
  EXPECT_NEAR(network.paint.line_width, 4 * 0.0254 * 0.5, 1e-12);
  const RoadNetwork moved = small("origin = [40.001, -83.0]");
  EXPECT_NEAR(at(moved, {1, 1, 1}).y, -0.001 * kLatitude, 1e-3);
}

// Precedence of widths: the lane's own, the sidecar's for all lanes, the file's in feet, 12 ft with a warning.
TEST(RoadNetwork, Widths) {
  std::vector<Warning> warnings;
  const Rndf rndf =
      parse_rndf("small.rndf", small_with("num_waypoints 2\nexit", "num_waypoints 2\nlane_width 0\nexit"));
  const RoadNetwork plain = build_network(rndf, {}, warnings);
  EXPECT_NEAR(plain.lanes[0].width, 12 * kFoot, 1e-12);
  EXPECT_NEAR(plain.lanes[2].width, 12 * kFoot, 1e-12);
  EXPECT_EQ(lines_of(warnings), "32: lane 2.1 has no lane_width; assuming 12 ft\n");
  const RoadNetwork wide = small("lane_width_m = 0.5\n[lanes.\"1.2\"]\nwidth_m = 0.6");
  EXPECT_EQ(wide.lanes[0].width, 0.5);
  EXPECT_EQ(wide.lanes[1].width, 0.6);
  EXPECT_EQ(wide.lanes[2].width, 0.5);
  EXPECT_NEAR(plain.spots[0].width, 10 * kFoot, 1e-12);
  EXPECT_EQ(small("spot_width_m = 0.4").spots[0].width, 0.4);
  EXPECT_NEAR(build(small_with("spot_width 10\n", "")).spots[0].width, 9 * kFoot, 1e-12);
}

TEST(RoadNetwork, PointsInMetresReplaceDegrees) {
  const RoadNetwork network = small("scale = 0.1\nheading_deg = 30\n[points.\"1.1.2\"]\nposition = [4, 5]");
  EXPECT_EQ(at(network, {1, 1, 2}).x, 4.0);
  EXPECT_EQ(at(network, {1, 1, 2}).y, 5.0);
}

TEST(RoadNetwork, EdgesAreHalfAWidthFromTheCentre) {
  const RoadNetwork network = small();
  const RoadLane& lane = network.lanes[0];
  ASSERT_GE(lane.left_edge.size(), 2u);
  EXPECT_NEAR(lane.left_edge[0].y - lane.right_edge[0].y, 12 * kFoot, 1e-6);
  EXPECT_NEAR(lane.left_edge[0].y, 6 * kFoot, 1e-3);  // eastbound: left is north
}

TEST(RoadNetwork, StopLinesCrossTheirLane) {
  const RoadNetwork network = small();
  ASSERT_EQ(network.stops.size(), 1u);
  const StopLine& stop = network.stops[0];
  EXPECT_EQ(id_of(network, stop.at), (PointId{1, 1, 3}));
  EXPECT_NEAR(length(stop.left - stop.right), 12 * kFoot, 1e-9);
  EXPECT_NEAR(length(0.5 * (stop.left + stop.right) - at(network, {1, 1, 3})), 0.0, 1e-9);
  EXPECT_GT(stop.left.y, stop.right.y);
}

TEST(RoadNetwork, CheckpointsHavePositions) {
  const RoadNetwork network = small();
  ASSERT_NE(find_checkpoint(network, 2), nullptr);
  EXPECT_EQ(id_of(network, find_checkpoint(network, 2)->at), (PointId{3, 1, 2}));
  EXPECT_EQ(find_checkpoint(network, 1)->p.x, at(network, {1, 1, 2}).x);
  EXPECT_EQ(find_checkpoint(network, 3), nullptr);
  EXPECT_EQ(find_checkpoint(network, 0), nullptr);
}

TEST(RoadNetwork, EveryPointIsFound) {
  const RoadNetwork network = small();
  EXPECT_EQ(network.index.size(), 13u);
  for (const auto& [id, ref] : network.index) EXPECT_EQ(id_of(network, ref), id);
  EXPECT_FALSE(find_point(network, {1, 1, 4}).has_value());
  EXPECT_FALSE(find_point(network, {1, 1, 0}).has_value());
  EXPECT_FALSE(find_point(network, {9, 9, 9}).has_value());
}

std::set<std::string> onward(const RoadNetwork& network, PointId from) {
  std::set<std::string> all;
  for (const Transition& step : successors(network, *find_point(network, from)))
    all.insert(point_id_text(id_of(network, step.to)));
  return all;
}

TEST(RoadNetwork, Successors) {
  const RoadNetwork network = small();
  using Set = std::set<std::string>;
  EXPECT_EQ(onward(network, {1, 1, 1}), (Set{"1.1.2"}));
  EXPECT_EQ(onward(network, {1, 1, 3}), (Set{"2.1.1"}));           // an exit at the lane's end
  EXPECT_EQ(onward(network, {1, 2, 2}), Set{});                    // a dead end
  EXPECT_EQ(onward(network, {2, 1, 2}), (Set{"3.0.1"}));           // into a zone
  EXPECT_EQ(onward(network, {3, 0, 1}), (Set{"3.1.1", "3.0.3"}));  // to its spot and to its exit
  EXPECT_EQ(onward(network, {3, 0, 3}), (Set{"3.1.1", "1.2.1"}));  // out, or to the spot
  EXPECT_EQ(onward(network, {3, 1, 1}), (Set{"3.1.2"}));
  EXPECT_EQ(onward(network, {3, 1, 2}), (Set{"3.0.3"}));
  const auto steps = successors(network, *find_point(network, {1, 1, 1}));
  EXPECT_NEAR(steps[0].length, 0.001 * kLongitude, 1e-3);
  EXPECT_EQ(steps[0].kind, Transition::Kind::lane);
}

TEST(RoadNetwork, ConnectionsLeaveAndArriveInDirection) {
  const RoadNetwork network = small();
  for (const RoadExit& exit : network.exits) {
    const Curve way = exit_curve(network, exit);
    EXPECT_EQ(way.points.front().x, position_of(network, exit.from).x);
    EXPECT_EQ(way.points.back().y, position_of(network, exit.to).y);
    EXPECT_EQ(exit.length, way.s.back());
  }
}

TEST(RoadNetwork, LanesOfOnePointAreValid) {
  std::vector<Warning> warnings;
  const std::string text = with(small_with("num_waypoints 2", "num_waypoints 1"), "1.2.2 40.000050 -83.000000\n", "");
  const Rndf rndf =
      parse_rndf("x", with(text, "right_boundary broken_white\n", "right_boundary broken_white\nstop 1.2.1\n"));
  const RoadNetwork network = build_network(rndf, {}, warnings);
  EXPECT_EQ(network.lanes[1].points.size(), 1u);
  EXPECT_TRUE(network.lanes[1].left_edge.empty());
  EXPECT_EQ(length_of(network.lanes[1]), 0.0);
  EXPECT_EQ(network.stops.size(), 1u);  // that of the other lane
  EXPECT_FALSE(yaw_of(network, *find_point(network, {1, 2, 1})).has_value());
  EXPECT_NE(lines_of(warnings).find("lane 1.2 has one point only"), std::string::npos);
}

TEST(RoadNetwork, CoincidentPointsAreNamed) {
  std::vector<Warning> warnings;
  const RoadNetwork network =
      build_network(parse_rndf("x", small_with("1.1.2 40.000000 -82.999", "1.1.2 40.000000 -83.000")), {}, warnings);
  EXPECT_NE(lines_of(warnings).find("18: way-points 1.1.1 and 1.1.2 coincide"), std::string::npos);
  EXPECT_EQ(network.lanes[0].points[1].s, 0.0);
}

TEST(RoadNetwork, FarPointsAreNamedOnce) {
  std::vector<Warning> warnings;
  build_network(parse_rndf("x", small_with("1.2.1 40.000050 -82.998", "1.2.1 40.000050 82.998")), {}, warnings);
  EXPECT_NE(lines_of(warnings).find("26: 1.2.1 is "), std::string::npos) << lines_of(warnings);
  EXPECT_EQ(std::count_if(warnings.begin(), warnings.end(),
                          [](const Warning& w) { return w.message.find(" km from the origin") != std::string::npos; }),
            1);
}

// A lane of half a metre: with six decimals errors are visible, with nine they are not.
TEST(RoadNetwork, MoreDecimalsAreKept) {
  const RoadNetwork network =
      build(small_with("1.1.2 40.000000 -82.999000", "1.1.2 40.000000123 -82.999000"), "scale = 0.142857142857");
  EXPECT_NEAR(at(network, {1, 1, 2}).y - at(small("scale = 0.142857142857"), {1, 1, 2}).y, 123e-9 * kLatitude / 7,
              1e-6);
}

// Edges of real lanes are half a width from the centre line, within the tolerance.
TEST(RoadNetworkFiles, EdgesKeepTheirDistance) {
  const std::string folder = SF_SOURCE_DIR "/../shared/data/rndf/";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no shared data next to the sources";
  for (const char* file : {"darpa_sample/uce_rndf_1_final_event.rndf", "darpa_sample/Sample_RNDF_Rev_1.5.rndf"}) {
    std::vector<Warning> warnings;
    const RoadNetwork network = load_roads(folder + file, warnings);
    for (const RoadLane& lane : network.lanes) {
      const double half = 0.5 * lane.width;
      for (const auto* edge : {&lane.left_edge, &lane.right_edge}) {
        ASSERT_GE(edge->size(), 2u) << lane_name(network, lane);
        for (std::size_t i = 0; i < edge->size(); i += 3) {
          double nearest = INFINITY;
          for (const glm::dvec2& p : lane.centre.points) nearest = std::min(nearest, length(p - (*edge)[i]));
          // Distances to points of the centre line, not to its pieces, so they may be slightly larger.
          EXPECT_GE(nearest, half - 0.01) << lane_name(network, lane);
          EXPECT_LE(nearest, half + 3.0) << lane_name(network, lane);
        }
      }
    }
  }
}

std::set<int> missed_from(const RoadNetwork& network, PointId start, bool with_changes) {
  std::vector<PointRef> open{*find_point(network, start)};
  std::set<PointId> seen{start};
  while (!open.empty()) {
    const PointRef here = open.back();
    open.pop_back();
    for (const Transition& step : successors(network, here)) {
      EXPECT_GE(step.length, 0.0);
      if (seen.insert(id_of(network, step.to)).second) open.push_back(step.to);
    }
    for (const Transition& step : lane_changes(network, here))
      if (with_changes && seen.insert(id_of(network, step.to)).second) open.push_back(step.to);
  }
  std::set<int> missed;
  for (const RoadCheckpoint& checkpoint : network.checkpoints)
    if (seen.count(id_of(network, checkpoint.at)) == 0) missed.insert(checkpoint.id);
  return missed;
}

// All checkpoints can be reached from a start chute of the final, except three that need a lane change on George Blvd
// (segment 6), for which the file has no exit.
TEST(RoadNetworkFiles, CheckpointsOfTheFinalAreReachable) {
  const std::string file = SF_SOURCE_DIR "/../shared/data/rndf/darpa_sample/uce_rndf_1_final_event.rndf";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no shared data next to the sources";
  std::vector<Warning> warnings;
  const RoadNetwork network = load_roads(file, warnings);
  const PointId chute{38, 1, 1};  // the first start chute
  EXPECT_EQ(missed_from(network, chute, false), (std::set<int>{4, 84, 85}));
  EXPECT_EQ(missed_from(network, chute, true), std::set<int>{});
}

// 1.1 and 1.2 are the only adjacent lanes with the same direction in SimVille.
TEST(RoadNetwork, LaneChanges) {
  std::vector<Warning> warnings;
  const RoadNetwork network = load_roads(SF_SOURCE_DIR "/worlds/simville/simville.rndf", warnings);
  for (const auto& [id, at] : network.index) {
    const auto changes = lane_changes(network, at);
    const bool two_lanes = id.segment == 1 && (id.lane == 1 || id.lane == 2);
    if (!two_lanes) {
      EXPECT_TRUE(changes.empty()) << point_id_text(id);
    }
    for (const Transition& step : changes) {
      const PointId to = id_of(network, step.to);
      EXPECT_EQ(to.segment, 1) << point_id_text(id);
      EXPECT_EQ(to.lane, 3 - id.lane) << point_id_text(id);
      EXPECT_EQ(step.kind, Transition::Kind::change);
      EXPECT_GE(step.length, 1.2) << point_id_text(id);  // three widths, or slightly less on the outside of a bend
      EXPECT_LE(step.length, 2.6) << point_id_text(id);
    }
  }
  // On the straight line: 1.5 m ahead is the third of points 0.575 m apart. The last points have no change.
  const auto change = lane_changes(network, *find_point(network, {1, 1, 10}));
  ASSERT_EQ(change.size(), 1u);
  EXPECT_EQ(point_id_text(id_of(network, change[0].to)), "1.2.13");
  EXPECT_FALSE(lane_changes(network, *find_point(network, {1, 2, 14})).empty());
  EXPECT_TRUE(lane_changes(network, *find_point(network, {1, 1, 16})).empty());
}

/// Returns the lane changes from the start of a lane along +x to a parallel lane that starts at `p`. Both are 4 m wide.
std::size_t changes_to(glm::dvec2 p) {
  const auto place = [](const char* id, double x, double y) {
    return "[points.\"" + std::string(id) + "\"]\nposition = [" + std::to_string(x) + ", " + std::to_string(y) + "]\n";
  };
  const RoadNetwork network = build(R"(RNDF_name two
num_segments 1
num_zones 0
segment 1
num_lanes 2
lane 1.1
num_waypoints 2
1.1.1 0 0
1.1.2 0 0.001
end_lane
lane 1.2
num_waypoints 2
1.2.1 0.0001 0
1.2.2 0.0001 0.001
end_lane
end_segment
end_file
)",
                                    "lane_width_m = 4\n" + place("1.1.1", 0, 0) + place("1.1.2", 100, 0) +
                                        place("1.2.1", p.x, p.y) + place("1.2.2", 100, p.y));
  return lane_changes(network, *find_point(network, {1, 1, 1})).size();
}

TEST(RoadNetwork, LanesHalfAWidthToOneAndAHalfApartAreAdjacent) {
  for (const double side : {1.0, -1.0}) {
    EXPECT_EQ(changes_to({0, side * 0.49 * 4}), 0u);
    EXPECT_EQ(changes_to({0, side * 0.51 * 4}), 1u);
    EXPECT_EQ(changes_to({0, side * 1.49 * 4}), 1u);
    EXPECT_EQ(changes_to({0, side * 1.51 * 4}), 0u);
  }
}

TEST(RoadNetwork, LaneThatStartsFartherAheadIsNotAdjacentYet) {
  const auto ahead = [](double part) { return glm::dvec2{part, std::sqrt(1.0 - part * part)} * 4.0; };
  EXPECT_EQ(changes_to(ahead(0.29)), 1u);  // relative to its distance
  EXPECT_EQ(changes_to(ahead(0.31)), 0u);
}

}  // namespace
}  // namespace sf::world
