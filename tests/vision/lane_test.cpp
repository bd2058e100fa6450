// The ground as a raster, painted lines, and lanes.

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "tests/vision/painted_ground.h"
#include "vision/ground_raster.h"
#include "vision/lane_tracker.h"
#include "vision/opencv.h"

namespace sf::vision {

namespace {

struct SeenGround {
  Image ground, paint;
  std::vector<glm::dvec2> points;
};

SeenGround see_ground(const GroundCamera& camera, const Image& image, const GroundRaster& raster = {}) {
  SeenGround seen;
  const auto pixels = pixels_of(raster, camera.lens, camera.X_RC, camera.width, camera.height);
  opencv().make_paint_finder(raster, {}, pixels)->find(image, seen.ground, seen.paint);
  seen.points = paint_points(raster, {}, seen.ground, seen.paint);
  return seen;
}

GroundCamera distorted_ground_camera() {
  GroundCamera camera;
  camera.lens.distortion = {-0.12, 0.01, 0.001, -0.001};
  return camera;
}

GroundCamera fisheye_ground_camera() {
  GroundCamera camera;
  camera.lens.fisheye = true;
  camera.lens.distortion = {0.02, -0.004};
  return camera;
}

// Straight lines ahead at known places, through three lenses: within a cell of the raster near the robot.
TEST(GroundRaster, LinesAreWhereTheyArePainted) {
  for (const GroundCamera& camera : {GroundCamera(), distorted_ground_camera(), fisheye_ground_camera()}) {
    const Lane lane{.offset = 0.1, .width = 0.5};
    const SeenGround seen = see_ground(camera, image_of(camera, painted(lane)));
    std::size_t left = 0, right = 0;
    for (const glm::dvec2& p : seen.points) {
      const double y = p.y + lane.offset;
      (y > 0.0 ? left : right) += 1;
      EXPECT_NEAR(std::abs(y), 0.25, p.x < 0.7 ? 0.003 : 0.006) << "at " << p.x << " m";
    }
    EXPECT_GT(left, 120u) << "of 200 rows";
    EXPECT_GT(right, 120u);
  }
}

TEST(GroundRaster, CellsBesideTheImageAreUnseen) {
  const GroundCamera camera = distorted_ground_camera();
  // Behind the camera, and so far to the side that the lens would fold it into the image.
  const auto pixels = pixels_of({-1.0, 0.0, 3.0, 0.05}, camera.lens, camera.X_RC, camera.width, camera.height);
  for (const glm::dvec2& pixel : pixels) EXPECT_EQ(pixel, kUnseen);
}

/// A row of a raster with a line from each first to each last column.
std::vector<glm::dvec2> points_of_row(const std::vector<std::pair<int, int>>& lines, int unseen = 0) {
  const GroundRaster raster{0.2, 0.205, 0.25, 0.005};
  Image ground{raster.columns(), 1, 1, std::vector<std::uint8_t>(100, 150)}, paint = ground;
  std::fill(paint.pixels.begin(), paint.pixels.end(), std::uint8_t{0});
  std::fill_n(ground.pixels.begin(), unseen, std::uint8_t{0});
  for (const auto& [first, last] : lines)
    for (int column = first; column <= last; ++column) *paint.at(column, 0) = 60;
  return paint_points(raster, {}, ground, paint);
}

TEST(PaintPoints, LinesOfARow) {
  EXPECT_TRUE(points_of_row({}).empty()) << "no paint";
  ASSERT_EQ(points_of_row({{40, 42}}).size(), 1u);
  EXPECT_NEAR(points_of_row({{40, 42}})[0].y, (50 - 41.5) * 0.005, 1e-12) << "its middle";
  EXPECT_EQ(points_of_row({{40, 42}, {48, 50}}).size(), 1u) << "25 mm between them: a double line";
  EXPECT_EQ(points_of_row({{40, 42}, {49, 51}}).size(), 2u) << "30 mm between them: two lines";
  EXPECT_EQ(points_of_row({{40, 59}}).size(), 1u) << "as wide as allowed";
  EXPECT_TRUE(points_of_row({{40, 60}}).empty()) << "wider: a stop line along the row";
  EXPECT_TRUE(points_of_row({{0, 2}}).empty()) << "at the border of the raster it may be cut";
  EXPECT_TRUE(points_of_row({{99, 99}}).empty());
  EXPECT_TRUE(points_of_row({{40, 42}}, 35).empty()) << "5 cells from what is not seen: a part may be hidden";
  EXPECT_EQ(points_of_row({{40, 42}}, 34).size(), 1u);
}

// Against the distance from the centre of the arc, in another form.
RC_GTEST_PROP(Lane, LeftOfMiddleIsTheDistanceFromTheArc, ()) {
  const auto number = [](int most) { return *rc::gen::inRange(-most, most + 1) * 1e-3; };
  const Lane lane{number(200), number(500), number(1200), 0.5};
  const glm::dvec2 p{number(700), number(400)};
  RC_PRE(std::abs(lane.curvature) > 1e-3);
  const long double c = std::cos(static_cast<long double>(lane.heading)),
                    s = std::sin(static_cast<long double>(lane.heading)), u = c * p.x - s * p.y,
                    v = lane.offset + s * p.x + c * p.y, radius = 1.0L / lane.curvature;
  const long double far = std::hypot(u, v - radius), left = radius > 0.0L ? radius - far : radius + far;
  RC_ASSERT(std::abs(static_cast<double>(left_of_middle(lane, p) - left)) < 1e-9);
}

TEST(Lane, StraightIsTheLimitOfArcs) {
  EXPECT_EQ(left_of_middle({0.1, 0.0, 0.0, 0.5}, {1.0, 0.2}), 0.1 + 0.2);
  EXPECT_NEAR(left_of_middle({0.1, 0.2, 1e-12, 0.5}, {1.0, 0.2}), left_of_middle({0.1, 0.2, 0.0, 0.5}, {1.0, 0.2}),
              1e-11);
}

/// Points on the edges of a lane that a camera sees, with `noise`, and paint that is none of its edges.
std::vector<glm::dvec2> edge_points(const Lane& lane, bool left, bool right, bool clutter) {
  std::vector<glm::dvec2> points;
  for (double x = 0.3; x < 1.2; x += 0.005)
    for (const double side : {0.5, -0.5}) {
      if (!(side > 0.0 ? left : right)) continue;
      double y = 0.0;
      for (int k = 0; k < 30; ++k) y += 0.7 * (side * lane.width - left_of_middle(lane, {x, y}));
      if (std::abs(y) < 0.8) points.push_back({x, y});
    }
  for (double y = -0.7; clutter && y < 0.7; y += 0.02) points.push_back({0.9 + 0.3 * y, y});  // across
  return points;
}

Lane any_lane() {
  const auto number = [](int most) { return *rc::gen::inRange(-most, most + 1) * 1e-3; };
  return {number(100), number(200), number(800), 0.5 + number(100)};
}

// From one image, with both edges or one of them after that, and with paint across the lane.
RC_GTEST_PROP(LaneTracker, FindsTheLane, ()) {
  const Lane lane = any_lane();
  LaneTracker tracker{LaneLimits{}};
  RC_ASSERT(tracker.update(edge_points(lane, true, true, false)));
  for (int k = 0; k < 20; ++k) RC_ASSERT(tracker.update(edge_points(lane, k % 3 > 0, k % 3 < 2, true)));
  RC_ASSERT(std::abs(tracker.lane().offset - lane.offset) < 0.003);
  RC_ASSERT(std::abs(tracker.lane().heading - lane.heading) < 0.01);
  RC_ASSERT(std::abs(tracker.lane().curvature - lane.curvature) < 0.03);
  RC_ASSERT(std::abs(tracker.lane().width - lane.width) < 0.003);
}

TEST(LaneTracker, NeedsBothEdgesToFindALaneAndOneToSeeIt) {
  const Lane lane{.width = 0.5};
  LaneTracker tracker{LaneLimits{}};
  EXPECT_FALSE(tracker.update({})) << "no paint";
  EXPECT_FALSE(tracker.update(edge_points(lane, true, false, false))) << "one edge may be any line";
  EXPECT_FALSE(tracker.update(edge_points({.width = 0.2}, true, true, false))) << "narrower than any lane";
  EXPECT_FALSE(tracker.has_lane());
  EXPECT_TRUE(tracker.update(edge_points(lane, true, true, false)));
  EXPECT_TRUE(tracker.update(edge_points(lane, false, true, false)));
  EXPECT_FALSE(tracker.update({})) << "remembered, but not seen";
  EXPECT_TRUE(tracker.has_lane());
}

// Without images the lane moves past the robot until it is too uncertain.
TEST(LaneTracker, MovesWithTheRobot) {
  LaneTracker tracker{LaneLimits{}};
  const Lane lane{0.02, 0.1, 0.5, 0.5};
  for (int k = 0; k < 10; ++k) tracker.update(edge_points(lane, true, true, false));
  const base::Twist twist{0.2, 0.0, 0.1};  // in 1 s: 0.2 m ahead, and 0.1 rad of the lane's and the robot's turn
  const Lane before = tracker.lane();
  for (int k = 0; k < 100; ++k) tracker.move(twist, 0.01);
  EXPECT_NEAR(tracker.lane().heading, before.heading, 0.002);
  EXPECT_NEAR(tracker.lane().offset, before.offset + 0.2 * 0.1, 0.001);
  EXPECT_TRUE(tracker.has_lane());
  for (int k = 0; k < 100; ++k) tracker.move(twist, 1.0);
  EXPECT_FALSE(tracker.has_lane()) << "after 20 m";
}

}  // namespace

}  // namespace sf::vision
