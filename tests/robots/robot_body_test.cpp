#include "robots/robot_body.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/robots/scenes.h"
#include "tests/units.h"

namespace sf::robots {
namespace {

/// A 6 m by 4 m room with two robots of 0.3 m by 0.3 m.
world::World room() {
  world::World world = scenes::boxed_world(6.0, 4.0, {-3.0, -2.0});
  for (const base::Pose& X_WM : {base::Pose{-2.0, 0.0, 0.0, 0.0}, base::Pose{2.0, 1.0, 0.0, M_PI / 2}})
    scenes::add_mover(world, X_WM, scenes::rectangle({0.0, 0.0}, 0.3, 0.3));
  return world;
}

struct BodyTest : testing::Test {
  world::World world = room();
  RobotBody body{world, 0};
};

TEST_F(BodyTest, DrivesForTheElapsedTime) {
  body.move({0.2, 0.0, 0.0}, 100 * kMs);
  body.move({0.2, 0.0, 0.0}, 250 * kMs);
  EXPECT_NEAR(body.state().X_WM.x, -2.0 + 0.2 * 0.25, 1e-12);
  EXPECT_NEAR(body.distance(), 0.05, 1e-12);
  body.move({0.2, 0.0, 0.0}, 250 * kMs);  // zero time
  EXPECT_NEAR(body.distance(), 0.05, 1e-12);
}

TEST_F(BodyTest, SuspendedProcessDoesNotJump) {
  body.move({0.2, 0.0, 0.0}, 60'000 * kMs);
  EXPECT_NEAR(body.state().X_WM.x, -2.0 + 0.2 * 0.5, 1e-12);  // half a second
}

TEST_F(BodyTest, WallsStopIt) {
  for (int i = 1; i <= 100; ++i) body.move({-0.5, 0.0, 0.0}, i * 100 * kMs);
  EXPECT_TRUE(body.contact());
  EXPECT_GT(body.state().X_WM.x, -3.0);
  EXPECT_LT(body.distance(), 1.0);
}

TEST_F(BodyTest, FollowsARealRobot) {
  body.update_other(1, {1.0, 1.0, 0.0, 0.0}, {0.1, 0.0, 0.0}, 0);
  body.follow({-1.5, 0.5, 0.0, 1.0}, {0.2, 0.0, 0.3}, true, 200 * kMs);
  EXPECT_EQ(body.state().X_WM.x, -1.5);
  EXPECT_EQ(body.state().velocity.turn, 0.3);
  EXPECT_TRUE(body.contact()) << "its bumper, with nothing near it in the world";
  EXPECT_NEAR(body.state(1).X_WM.x, 1.02, 1e-9) << "the others continue";
  body.follow({-2.95, 0.5, 0.0, 1.0}, {}, false, 400 * kMs);
  EXPECT_FALSE(body.contact()) << "in a wall of the world file, and free";
  EXPECT_EQ(body.state().X_WM.x, -2.95);
  EXPECT_NEAR(body.distance(), std::hypot(0.5, 0.5) + 1.45, 1e-9);
  EXPECT_NEAR(body.pose_at(300 * kMs).X.x, -2.225, 1e-9);
}

/// The other robot reports a pose in the way, then sends nothing more.
TEST_F(BodyTest, LongSilentRobotIsNotAnObstacle) {
  for (const std::int64_t forget : {std::int64_t{0}, 2000 * kMs}) {
    RobotBody one(world, 0, forget);
    one.move({}, 100 * kMs);
    one.update_other(1, {-1.0, 0.0, 0.0, 0.0}, {}, 100 * kMs);
    for (int i = 2; i <= 20; ++i) one.move({0.5, 0.0, 0.0}, i * 100 * kMs);
    EXPECT_TRUE(one.contact());
    for (int i = 21; i <= 60; ++i) one.move({0.5, 0.0, 0.0}, i * 100 * kMs);
    EXPECT_EQ(one.contact(), forget == 0);
    EXPECT_EQ(one.state().X_WM.x > 0.0, forget > 0);
    one.update_other(1, {one.state().X_WM.x + 0.31, 0.0, 0.0, 0.0}, {}, 6000 * kMs);
    one.move({0.5, 0.0, 0.0}, 6100 * kMs);
    EXPECT_TRUE(one.contact()) << "it is back";
  }
}

TEST_F(BodyTest, OthersContinueFromTheirReportsForHalfASecond) {
  body.move({}, 100 * kMs);
  body.update_other(1, {0.0, 1.0, 0.0, 0.0}, {0.4, 0.0, 0.0}, 100 * kMs);
  EXPECT_EQ(body.state(1).X_WM.x, 0.0);
  for (int i = 2; i <= 20; ++i) body.move({}, i * 100 * kMs);
  EXPECT_NEAR(body.state(1).X_WM.x, 0.4 * 0.4, 0.041);  // moves that end within the half second
  body.update_other(1, {1.5, 1.0, 0.0, 0.0}, {}, 2000 * kMs);
  EXPECT_EQ(body.state(1).X_WM.x, 1.5);  // the newest state is used
}

TEST_F(BodyTest, IsStoppedByOthers) {
  body.update_other(1, {-1.5, 0.0, 0.0, 0.0}, {}, 0);
  for (int i = 1; i <= 20; ++i) body.move({0.5, 0.0, 0.0}, i * 100 * kMs);
  EXPECT_TRUE(body.contact());
  EXPECT_LT(body.state().X_WM.x, -1.5 - 0.29);
}

TEST_F(BodyTest, KeepsItsPastPoses) {
  for (int i = 1; i <= 10; ++i) body.move({0.2, 0.0, 0.0}, i * 100 * kMs);
  EXPECT_NEAR(body.pose_at(350 * kMs).X.x, -2.0 + 0.2 * 0.35, 1e-12);  // between two moves
  EXPECT_NEAR(body.pose_at(400 * kMs).X.x, -2.0 + 0.2 * 0.4, 1e-12);   // at a move
  EXPECT_EQ(body.pose_at(-5).X.x, -2.0);                               // before the first
  EXPECT_EQ(body.pose_at(2000 * kMs).X.x, body.state().X_WM.x);        // after the last
}

TEST_F(BodyTest, DropsOldPoses) {
  for (int i = 1; i <= 1000; ++i) body.move({0.0, 0.0, 0.5}, i * kMs);
  EXPECT_NEAR(body.pose_at(900 * kMs).X.yaw, 0.45, 1e-9);
  EXPECT_NEAR(body.pose_at(0).X.yaw, 0.5 * 0.745, 1e-9);  // the oldest of 256
}

TEST_F(BodyTest, HeadingsInterpolateAcrossHalfATurn) {
  world.movers[0].X_WM.yaw = M_PI - 0.01;
  RobotBody turned(world, 0);
  turned.move({0.0, 0.0, 0.2}, 100 * kMs);
  EXPECT_NEAR(std::abs(turned.pose_at(50 * kMs).X.yaw), M_PI, 1e-9);
}

}  // namespace
}  // namespace sf::robots
