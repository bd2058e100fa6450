// Lane keeping by a camera in a closed loop: a unicycle on painted ground, images computed pixel by pixel.

#include "control/lane_camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "robots/kinematics.h"
#include "sensors/camera.h"
#include "tests/robots/scenes.h"
#include "tests/units.h"
#include "tests/vision/painted_ground.h"

namespace sf::control {
namespace {

using base::Pose;
using base::Twist;

constexpr double kWidth = 0.5;  // [m]

/// A Create with the camera of tests/vision/painted_ground.h, at a quarter of its pixels.
vision::GroundCamera small_camera() {
  vision::GroundCamera camera;
  camera.width = 160, camera.height = 120;
  camera.lens.focal = {80.0, 80.0}, camera.lens.center = {79.5, 59.5};
  return camera;
}

world::World camera_world(double rgb = 1.0) {
  world::World world = scenes::empty_world();
  scenes::add_create(world, {0, 0, 0, 0})
      .sensors.push_back(
          {.type = "camera",
           .X_MS = {0.1, 0, 0.3, 0},
           .settings = {
               {"resolution", {160, 120}}, {"fov", {M_PI / 2}}, {"pose6", {0, 0, 0, 0, 0.5585, 0}}, {"rgb", {rgb}}}});
  return world;
}

std::unique_ptr<Controller> make_driver(const world::World& world, std::vector<Setting> numbers = {}) {
  Settings settings("controller 'lane-camera'", std::move(numbers));
  return lane_camera_controller.make({world}, settings);
}

/// Lane of a robot in a world whose lane begins at the origin along x, with constant curvature.
vision::Lane lane_at(const Pose& X_WM, double curvature) {
  if (curvature == 0.0) return {X_WM.y, X_WM.yaw, 0.0, kWidth};
  const double radius = 1.0 / curvature, from = std::hypot(X_WM.x, X_WM.y - radius);
  const double along = std::atan2(X_WM.x * curvature, (radius - X_WM.y) * curvature);
  return {radius - std::copysign(from, radius), base::wrap_angle(X_WM.yaw - along), curvature, kWidth};
}

std::vector<double> reading_of(const vision::Image& image) {
  std::vector<double> values;
  for (const std::uint8_t grey : image.pixels) values.insert(values.end(), {1.0, grey * 65536.0 + grey * 256.0 + grey});
  return values;
}

struct CameraDrive {
  Pose X_WM;
  std::vector<Twist> twists;
  std::vector<double> errors;
  double farthest = 0.0;  // [m] from the middle
};

/// @param image_every steps of 0.1 s from one image to the next @param paint whether there is any, by step
CameraDrive drive_by_camera(
    double curvature, Pose X_WM, int steps, int image_every = 1,
    const std::function<bool(int)>& paint = [](int) { return true; }) {
  const world::World world = camera_world();
  const vision::GroundCamera camera = small_camera();
  const auto controller = make_driver(world, {{"speed", 0.2, ""}});
  CameraDrive result;
  std::vector<double> values;
  base::ReadingBlock block{.type = sensors::kCamera};
  const Pose unknown{NAN, NAN, NAN, NAN};  // the controller must do without
  for (int k = 0; k < steps; ++k) {
    if (k % image_every == 0) {
      const vision::Ground ground = vision::painted(lane_at(X_WM, curvature));
      values = reading_of(image_of(
          camera, paint(k) ? ground : [](glm::dvec2) -> std::uint8_t { return 165; }, 2));
      block.values = values, block.sequence = static_cast<std::uint32_t>(k), block.time = k * kTick;
      block.X_WM = block.X_WS = unknown;
    }
    result.twists.push_back(controller->step({.time = k * kTick, .state = {.X_WM = unknown}, .readings = {&block, 1}}));
    result.errors.push_back(controller->error());
    result.farthest = std::max(result.farthest, std::abs(lane_at(X_WM, curvature).offset));
    X_WM = robots::advance(X_WM, result.twists.back(), 0.1);
  }
  result.X_WM = X_WM;
  return result;
}

TEST(LaneCamera, ReturnsToTheMiddleOfAStraightLane) {
  const CameraDrive d = drive_by_camera(0.0, {0.0, 0.08, 0.0, 0.1}, 40);
  EXPECT_LT(d.farthest, 0.1);
  EXPECT_NEAR(d.X_WM.y, 0.0, 0.003);
  EXPECT_NEAR(d.X_WM.yaw, 0.0, 0.01);
}

// As `lane-keeping`, whose law is the same: off by l^2 / 2R at the robot, v / (R kp) ahead of it.
TEST(LaneCamera, KeepsItsLaneInBends) {
  for (const double curvature : {0.8, -0.8}) {
    const CameraDrive d = drive_by_camera(curvature, {}, 40);
    const double kp = 2.0 * 0.2 / (0.225 * 0.225);
    EXPECT_NEAR(d.errors.back(), 0.2 * curvature / kp, 0.005);
    EXPECT_LT(d.farthest, 0.03);
  }
}

// Two images a second: the track moves with the commands between them.
TEST(LaneCamera, DrivesOnBetweenImages) {
  const CameraDrive often = drive_by_camera(0.8, {}, 40), rarely = drive_by_camera(0.8, {}, 40, 5);
  EXPECT_LT(rarely.farthest, 0.03);
  for (std::size_t k = 20; k < 40; ++k) EXPECT_NEAR(rarely.errors[k], often.errors[k], 0.006) << k;
}

TEST(LaneCamera, SlowsDownAndStopsWithoutPaint) {
  const CameraDrive d = drive_by_camera(0.0, {}, 40, 1, [](int k) { return k < 5; });
  EXPECT_EQ(d.twists[14].forward, 0.2) << "1 s after the last image with paint";
  EXPECT_NEAR(d.twists[19].forward, 0.1, 1e-9) << "1.5 s";
  EXPECT_EQ(d.twists[24].forward, 0.0) << "2 s";
  EXPECT_TRUE(std::isnan(d.errors[24]));
  const CameraDrive again = drive_by_camera(0.0, {}, 45, 1, [](int k) { return k < 5 || k > 40; });
  EXPECT_EQ(again.twists[44].forward, 0.2) << "drives on as soon as it sees a lane again";
}

TEST(LaneCamera, StatesWhyItStops) {
  const world::World world = camera_world();
  const auto controller = make_driver(world);
  EXPECT_EQ(controller->step({}).forward, 0.0);
  EXPECT_EQ(stop_reason_of(*controller), "no new images arrive from its camera") << "none so far";
  const std::vector<double> values = reading_of(image_of(
      small_camera(), [](glm::dvec2) -> std::uint8_t { return 165; }, 1));
  const base::ReadingBlock block{.type = sensors::kCamera, .values = values};
  EXPECT_EQ(controller->step({.readings = {&block, 1}}).forward, 0.0);
  EXPECT_EQ(stop_reason_of(*controller), "its camera sees no lane");
  controller->step({.time = 11 * kTick, .readings = {&block, 1}});
  EXPECT_EQ(stop_reason_of(*controller), "no new images arrive from its camera") << "the same image after 1.1 s";
}

TEST(LaneCamera, RepeatsItsBytes) {
  const CameraDrive a = drive_by_camera(0.8, {0.0, 0.02, 0.0, 0.0}, 15),
                    b = drive_by_camera(0.8, {0.0, 0.02, 0.0, 0.0}, 15);
  for (std::size_t k = 0; k < a.twists.size(); ++k) EXPECT_EQ(a.twists[k].turn, b.twists[k].turn) << k;
}

std::string driver_refusal(const world::World& world, std::vector<Setting> settings = {}) {
  try {
    make_driver(world, std::move(settings));
  } catch (const base::InputError& error) {
    return error.what();
  }
  return "";
}

TEST(LaneCamera, RefusesWhatItCannotUse) {
  world::World blind = scenes::empty_world();
  scenes::add_create(blind, {0, 0, 0, 0});
  EXPECT_NE(driver_refusal(blind).find("has no camera with colours; give it a camera( rgb 1"), std::string::npos);
  EXPECT_NE(driver_refusal(camera_world(0.0)).find("has no camera with colours"), std::string::npos) << "depths alone";
  const world::World world = camera_world();
  EXPECT_NE(driver_refusal(world, {{"cell", 0.0005, ""}}).find("at most 1e+06 in all"), std::string::npos)
      << "6 400 000 cells";
  EXPECT_NE(driver_refusal(world, {{"far", 0.2, ""}}).find("at least 10 x 20"), std::string::npos) << "no ground";
  EXPECT_EQ(driver_refusal(world, {{"far", 0.25, ""}}), "");
}

}  // namespace
}  // namespace sf::control
