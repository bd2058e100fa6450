// Marks of a world in a camera's image.

#include "vision/overlay.h"

#include <gtest/gtest.h>

#include "tests/vision/cameras.h"

namespace sf::vision {

namespace {

world::Segment wall(glm::dvec2 a, glm::dvec2 b, double top = 0.5) {
  world::Segment segment;
  segment.a = a;
  segment.b = b;
  segment.z_max = top;
  return segment;
}

world::World world_of(std::vector<world::Segment> walls) {
  world::World world;
  world.walls = std::move(walls);
  return world;
}

}  // namespace

TEST(Overlay, MarksWallsWhereTheCameraProjectsThem) {
  const Camera camera = distorted_camera();
  const std::vector<Mark> marks = world_marks(camera, world_of({wall({-1.0, 0.5}, {1.0, -0.25})}));
  ASSERT_EQ(marks.size(), 2u);  // its foot and its top
  for (std::size_t i = 0; i < 2; ++i) {
    const double z = i == 0 ? 0.0 : 0.5;
    EXPECT_EQ(marks[i].points.front(), *project(camera, {-1.0, 0.5, z}));
    EXPECT_EQ(marks[i].points.back(), *project(camera, {1.0, -0.25, z}));
    EXPECT_GT(marks[i].points.size(), 40u);  // pieces of 5 cm, which the lens bends
  }
}

TEST(Overlay, MarksLinesAtTheirHeightAndInTheirColour) {
  const Camera camera = distorted_camera();
  const std::vector<PlaneLine> lines{{{{0.0, 0.0}, {0.5, 0.5}}, 0.2, {1, 2, 3}, 4}, {{{9.0, 9.0}, {9.0, 8.0}}, 0.2}};
  const std::vector<Mark> marks = line_marks(camera, lines);
  ASSERT_EQ(marks.size(), 1u) << "the other is out of sight";
  EXPECT_EQ(marks[0].points.back(), *project(camera, {0.5, 0.5, 0.2}));
  EXPECT_EQ(marks[0].color, lines[0].color);
  EXPECT_EQ(marks[0].width, 4);
}

/// A label ends with the speed of a tag that is tracked, and stays inside the picture.
TEST(Overlay, LabelsHaveSpeeds) {
  const Camera camera = distorted_camera();
  Sighting seen;
  seen.id = 7;
  const auto low = to_plane(camera, {600.0, camera.intrinsics.height - 2.0}, 0.0);
  ASSERT_TRUE(low);
  seen.fit.X_WT = {low->x, low->y, 0.0, 0.0};
  seen.fit.side = 0.15;
  seen.fit.pixel = 0.004;
  TrackedTag other, same;
  other.id = 8;
  same.id = 7;
  same.velocity = {0.3, -0.4};
  const auto texts = [&](std::vector<TrackedTag> tracked) {
    std::vector<std::string> found;
    for (const Mark& mark : tag_marks(camera, {{seen}}, tracked)) {
      if (mark.text.empty()) continue;
      found.push_back(mark.text);
      EXPECT_LT(mark.points[0].y, camera.intrinsics.height) << mark.text;
    }
    return found;
  };
  EXPECT_EQ(texts({other}).size(), 2u);
  ASSERT_EQ(texts({other, same}).size(), 3u);
  EXPECT_EQ(texts({other, same})[2], "0.50 m/s");
}

TEST(Overlay, ClipsToThePicture) {
  const Camera camera = distorted_camera();
  // 5 m x 4 m are visible: walls outside of this area, through it, around it, and of extreme length, with a bounded
  // number of pieces.
  EXPECT_TRUE(world_marks(camera, world_of({wall({4.0, -9.0}, {4.0, 9.0}), wall({50.0, 0.0}, {60.0, 0.0})})).empty());
  for (const double far : {3.0, 100.0, 1e7}) {
    const std::vector<Mark> marks = world_marks(camera, world_of({wall({-far, 0.1}, {far, 0.2}, 0.0)}));
    ASSERT_EQ(marks.size(), 2u) << far;
    const double along = far > 3.0 ? 0.15 : 0.1 + 0.1 * 3.5 / 6.0;  // [m] y at x = 0.5 m
    EXPECT_LT(marks[0].points.size(), 140u) << far;
    double nearest = 1e9;
    for (const glm::dvec2& p : marks[0].points) {
      EXPECT_TRUE(p.x > -20.0 && p.x < 1300.0 && p.y > -20.0 && p.y < 1044.0) << p.x << " " << p.y;
      nearest = std::min(nearest, std::abs(p.y - project(camera, {0.5, along, 0.0})->y));
    }
    EXPECT_LT(nearest, 2.0) << far;
  }
  // One line that leaves the picture and enters it again: two pieces.
  world::World bent;
  bent.lane_markings.push_back({{{0.0, 0.0}, {9.0, 0.0}, {9.0, 1.0}, {0.0, 1.0}}, 0.02});
  EXPECT_EQ(world_marks(camera, bent).size(), 2u);
}

TEST(Overlay, ClipsForCamerasThatSeeTheHorizon) {
  Camera camera = plain_camera();
  camera.forward = {1.0, 0.0, 0.0};
  camera.right = {0.0, -1.0, 0.0};
  camera.down = {0.0, 0.0, -1.0};
  EXPECT_EQ(world_marks(camera, world_of({wall({-20.0, 0.0}, {40.0, 0.0}, 0.0)})).size(), 2u);
  EXPECT_TRUE(world_marks(camera, world_of({wall({-20.0, 3.0}, {-40.0, 3.0}, 0.0)})).empty());  // behind it
}

}  // namespace sf::vision
