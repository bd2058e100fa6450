#include "scenarios/lane_errors.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sf::scenarios {
namespace {

/// Along x: 2 m of a lane 0.5 m wide, then 1 m of one 0.3 m wide.
world::Path straight() {
  return {"p",
          {{.X_WP = {}, .length = 2.0, .curvature = 0.0, .width = 0.5},
           {.X_WP = {2.0, 0.0, 0.0, 0.0}, .length = 1.0, .curvature = 0.0, .width = 0.3}}};
}

viz::Track track_of(const std::vector<glm::dvec2>& points) {
  viz::Track track;
  for (const glm::dvec2& p : points) track.poses.push_back({p.x, p.y, 0.0, 0.0});
  return track;
}

TEST(LaneErrors, NoPosesGiveZeros) {
  const LaneErrors none = lane_errors({}, straight());
  EXPECT_EQ(none.mean_abs, 0.0);
  EXPECT_EQ(none.max_abs, 0.0);
  EXPECT_EQ(none.amplitude, 0.0);
  EXPECT_FALSE(none.left_lane);
}

TEST(LaneErrors, BothSidesCount) {
  const LaneErrors errors = lane_errors(track_of({{0.5, 0.1}, {1.5, -0.2}, {1.8, 0.0}, {2.9, 0.06}}), straight());
  EXPECT_NEAR(errors.mean_abs, 0.09, 1e-12);
  EXPECT_NEAR(errors.max_abs, 0.2, 1e-12);
}

/// A wave of 3 cm about an offset of 5 cm on the straight; poses before and after it do not count.
TEST(LaneErrors, TheAmplitudeIsThatOfTheStraight) {
  std::vector<glm::dvec2> points{{0.9, -0.2}, {2.7, 0.2}};
  for (int i = 0; i < 1600; ++i) {
    const double x = kStraight[0] + 1e-3 * (i + 0.5);
    points.push_back({x, 0.05 + 0.03 * std::sin(2.0 * M_PI * x / 0.4)});
  }
  const LaneErrors errors = lane_errors(track_of(points), straight());
  EXPECT_NEAR(errors.amplitude, 0.03, 1e-6);
  EXPECT_NEAR(errors.max_abs, 0.2, 1e-12) << "over the whole track";
  EXPECT_EQ(lane_errors(track_of({{0.9, 0.1}, {0.95, -0.1}}), straight()).amplitude, 0.0) << "none on the straight";
}

TEST(LaneErrors, TheEdgeIsHalfTheLocalWidthFromTheMiddle) {
  for (const double side : {1.0, -1.0}) {
    EXPECT_FALSE(lane_errors(track_of({{1.0, 0.24 * side}, {2.5, 0.14 * side}}), straight()).left_lane);
    EXPECT_TRUE(lane_errors(track_of({{1.0, 0.26 * side}, {2.5, 0.0}}), straight()).left_lane);
    EXPECT_TRUE(lane_errors(track_of({{2.5, 0.16 * side}, {1.0, 0.0}}), straight()).left_lane) << "the narrow piece";
  }
}

}  // namespace
}  // namespace sf::scenarios
