#include "vision/rendered_robots.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sf::vision {

namespace {

Testbed offset_testbed() {
  return parse_testbed(
      "t.toml",
      "dictionary = \"aruco_4x4_50\"\ntag_height = 0.2\n[[camera]]\nname = \"a\"\nsize = [64, 48]\n"
      "focal = [60, 60]\nposition = [0, 0, 3]\n[[tag]]\nid = 3\nheight = 0.31\noffset = [0.1, 0, 90]\n");
}

}  // namespace

TEST(RenderedRobots, TagsAreOnTheirRobots) {
  const Testbed testbed = offset_testbed();
  RenderedRobots robots(testbed);
  ASSERT_TRUE(robots.update(3, {1.0, 2.0, 9.0, M_PI / 2.0}, {0.5, 0.0}, 2.0, 10.0));
  const Scene scene = robots.scene_at(10.1);
  ASSERT_EQ(scene.patches.size(), 2u);  // a body and its tag
  const Patch& tag = scene.patches[1];
  EXPECT_NEAR(tag.X_WP.x, 1.0, 1e-12);
  EXPECT_NEAR(tag.X_WP.y, 2.1, 1e-12);
  EXPECT_NEAR(tag.X_WP.z, 9.31, 1e-12) << "on top of the robot";
  EXPECT_NEAR(std::abs(tag.X_WP.yaw), M_PI, 1e-12);
  EXPECT_NEAR(tag.velocity.x, 0.5 - 2.0 * 0.1, 1e-12) << "turning carries the tag sideways";
  EXPECT_NEAR(pose_at(tag, 10.1).x, 1.0 + 0.1 * 0.3, 1e-12);
}

/// Boundary: no packets for longer than the extrapolation. The robot then stops.
TEST(RenderedRobots, SilentRobotsStop) {
  const Testbed testbed = offset_testbed();
  RenderedRobots robots(testbed);
  robots.update(1, {}, {1.0, 0.0}, 0.0, 0.0);
  for (const double time : {0.6, 5.0}) EXPECT_NEAR(pose_at(robots.scene_at(time).patches[1], time).x, 0.5, 1e-12);
}

/// Boundary: the last id of the dictionary, and the one after it.
TEST(RenderedRobots, RejectsTagsOutsideTheDictionary) {
  const Testbed testbed = offset_testbed();
  RenderedRobots robots(testbed);
  EXPECT_TRUE(robots.update(49, {}, {}, 0.0, 0.0));
  EXPECT_FALSE(robots.update(50, {}, {}, 0.0, 0.0));
  EXPECT_EQ(robots.size(), 1u);
}

}  // namespace sf::vision
