// Lane markings: number, position and length of dashes.

#include "world/roads/lane_markings.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "tests/world/rndf_text.h"
#include "world/roads/roads.h"

namespace sf::world {
namespace {

// One straight lane of 100 m along +x, 4 m wide, placed in metres.
const std::string kLane = R"(RNDF_name one
num_segments 1
num_zones 0
segment 1
num_lanes 1
lane 1.1
num_waypoints 2
left_boundary LEFT
right_boundary RIGHT
stop 1.1.2
1.1.1 0 0
1.1.2 0 0.001
end_lane
end_segment
end_file
)";

std::vector<LaneMarking> paint(const std::string& left, const std::string& right, const std::string& sidecar = "") {
  std::string text = left.empty() ? with(kLane, "left_boundary LEFT\n", "") : with(kLane, "LEFT", left);
  text = right.empty() ? with(text, "right_boundary RIGHT\n", "") : with(text, "RIGHT", right);
  std::vector<Warning> warnings;
  return lane_markings_of(
      build_network(parse_rndf("one.rndf", with(text, "stop 1.1.2\n", "")),
                    parse_sidecar("one.toml",
                                  "lane_width_m = 4\n" + sidecar +
                                      "[points.\"1.1.1\"]\nposition = [0, 0]\n[points.\"1.1.2\"]\nposition = "
                                      "[100, 0]\n",
                                  warnings),
                    warnings));
}

double length_of(const LaneMarking& stripe) {
  double sum = 0.0;
  for (std::size_t i = 1; i < stripe.line.size(); ++i) sum += length(stripe.line[i] - stripe.line[i - 1]);
  return sum;
}

TEST(LaneMarkings, UnspecifiedBoundariesHaveNoPaint) { EXPECT_TRUE(paint("", "").empty()); }

TEST(LaneMarkings, SolidLinesAreOnTheEdges) {
  const auto lane_markings = paint("solid_yellow", "solid_white");
  ASSERT_EQ(lane_markings.size(), 2u);
  EXPECT_EQ(lane_markings[0].color, kYellowPaint);
  EXPECT_EQ(lane_markings[0].line[0].y, 2.0);
  EXPECT_EQ(lane_markings[1].color, kWhitePaint);
  EXPECT_EQ(lane_markings[1].line[0].y, -2.0);
  EXPECT_DOUBLE_EQ(length_of(lane_markings[1]), 100.0);
  EXPECT_DOUBLE_EQ(lane_markings[0].width, 0.1016);  // 4 inches
}

TEST(LaneMarkings, DoubleLinesAreOnBothSidesOfTheEdge) {
  const auto lane_markings = paint("double_yellow", "double_yellow");
  ASSERT_EQ(lane_markings.size(), 4u);
  for (const std::size_t i : {0u, 2u}) {
    EXPECT_NEAR(std::abs(lane_markings[i].line[0].y - lane_markings[i + 1].line[0].y), 2 * 0.1016, 1e-12);
    EXPECT_NEAR(std::abs(0.5 * (lane_markings[i].line[0].y + lane_markings[i + 1].line[0].y)), 2.0, 1e-12);
    EXPECT_EQ(lane_markings[i].color, kYellowPaint);
  }
  EXPECT_GT(lane_markings[0].line[0].y, 0.0);
  EXPECT_LT(lane_markings[2].line[0].y, 0.0);
}

// 100 m at 40 ft: eight whole dashes of 10 ft and the start of a ninth.
TEST(LaneMarkings, DashesHaveTheirLengthExceptTheLast) {
  const auto lane_markings = paint("", "broken_white");
  ASSERT_EQ(lane_markings.size(), 9u);
  for (std::size_t k = 0; k < lane_markings.size(); ++k) {
    const double begin = static_cast<double>(k) * 40 * kFoot;
    EXPECT_NEAR(lane_markings[k].line.front().x, begin, 1e-9);
    EXPECT_NEAR(length_of(lane_markings[k]), std::min(10 * kFoot, 100.0 - begin), 1e-9);
    EXPECT_EQ(lane_markings[k].line.front().y, -2.0);
  }
  EXPECT_LT(length_of(lane_markings[8]), 10 * kFoot);
}

TEST(LaneMarkings, SidecarSetsSizes) {
  const auto lane_markings = paint("", "broken_white", "paint_width_m = 0.2\ndash_length_m = 30\ndash_gap_m = 20\n");
  ASSERT_EQ(lane_markings.size(), 2u);  // 0 to 30, 50 to 80; the next would start at 100
  EXPECT_EQ(lane_markings[0].width, 0.2);
  EXPECT_NEAR(lane_markings[1].line.back().x, 80.0, 1e-9);
}

TEST(LaneMarkings, DashesFollowBends) {
  std::vector<Warning> warnings;
  std::string text = with(with(kLane, "left_boundary LEFT\n", ""), "RIGHT", "broken_white");
  text = with(with(text, "num_waypoints 2", "num_waypoints 7"), "stop 1.1.2\n", "");
  std::string points, sidecar = "lane_width_m = 4\n";
  for (int i = 1; i <= 7; ++i) {
    points += "1.1." + std::to_string(i) + " 0 0\n";
    const glm::dvec2 p = base::rotate(i * M_PI / 12, {30.0, 0.0});
    sidecar += "[points.\"1.1." + std::to_string(i) + "\"]\nposition = [" + std::to_string(p.x) + ", " +
               std::to_string(p.y) + "]\n";
  }
  text = with(text, "1.1.1 0 0\n1.1.2 0 0.001\n", points);
  const auto lane_markings = lane_markings_of(
      build_network(parse_rndf("one.rndf", text), parse_sidecar("one.toml", sidecar, warnings), warnings));
  ASSERT_EQ(lane_markings.size(), 5u);  // the outer edge is 50.3 m long: dashes start every 12.192 m
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(length_of(lane_markings[k]), 10 * kFoot, 1e-6);
    for (const glm::dvec2& p : lane_markings[k].line) EXPECT_NEAR(length(p), 32.0, 2e-3);
  }
}

TEST(LaneMarkings, SharpTurnStartsANewMarking) {
  RoadNetwork network;
  network.lanes.push_back({.left = Boundary::solid_white, .left_edge = {{0, 0}, {2, 0}, {1, 1}, {0, 2}, {0, 0}}});
  const auto lane_markings = lane_markings_of(network);
  ASSERT_EQ(lane_markings.size(), 3u);  // turns of 135 degrees at the second and the fourth point, of 0 at the third
  EXPECT_EQ(lane_markings[0].line, (std::vector<glm::dvec2>{{0, 0}, {2, 0}}));
  EXPECT_EQ(lane_markings[1].line, (std::vector<glm::dvec2>{{2, 0}, {1, 1}, {0, 2}}));
  EXPECT_EQ(lane_markings[2].line, (std::vector<glm::dvec2>{{0, 2}, {0, 0}}));
}

TEST(LaneMarkings, StopLinesAndSpots) {
  std::vector<Warning> warnings;
  const RoadNetwork network = build_network(small_rndf(), {}, warnings);
  const auto lane_markings = lane_markings_of(network);
  std::size_t stops = 0;
  for (const LaneMarking& stripe : lane_markings) stops += stripe.width == network.paint.stop_width;
  EXPECT_EQ(stops, 1u);
  EXPECT_NEAR(network.paint.stop_width, 0.3048, 1e-12);
  ASSERT_GE(lane_markings.size(), 3u);  // the last three: two sides of the spot and its end
  EXPECT_NEAR(length_of(lane_markings[lane_markings.size() - 3]), length(network.spots[0].end - network.spots[0].entry),
              1e-9);
  EXPECT_NEAR(length_of(lane_markings.back()), 10 * kFoot, 1e-9);
}

TEST(LaneMarkings, TooManyDashesAreRejected) {
  expect_in("more than 1000000 painted", sf::refusal_of([] {
              paint("broken_white", "broken_white", "dash_length_m = 0.00001\ndash_gap_m = 0.00001\n");
            }));
}

// Checks the invariants of world::LaneMarking in all public networks.
TEST(LaneMarkingFiles, StripesAreValid) {
  const std::string folder = SF_SOURCE_DIR "/../shared/data/rndf/";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no shared data next to the sources";
  for (const char* file : {"darpa_sample/uce_rndf_1_final_event.rndf", "darpa_sample/Sample_RNDF_Rev_1.5.rndf",
                           "utexas/swri_site_visit_with_zones.rndf", "utexas/prc_large.rndf"}) {
    std::vector<Warning> warnings;
    for (const LaneMarking& stripe : lane_markings_of(load_roads(folder + file, warnings))) {
      ASSERT_GE(stripe.line.size(), 2u);
      ASSERT_GT(stripe.width, 0.0);
      for (std::size_t i = 1; i < stripe.line.size(); ++i) ASSERT_GT(length(stripe.line[i] - stripe.line[i - 1]), 0.0);
      for (std::size_t i = 1; i + 1 < stripe.line.size(); ++i)
        ASSERT_GT(dot(stripe.line[i] - stripe.line[i - 1], stripe.line[i + 1] - stripe.line[i]), 0.0);
    }
  }
}

}  // namespace
}  // namespace sf::world
