// Intrinsics from rendered images of a chessboard, against those that they were rendered with.

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "base/error.h"
#include "tests/vision/cameras.h"
#include "vision/opencv.h"
#include "vision/renderer.h"

namespace sf::vision {

namespace {

constexpr int kSquares = 10;
constexpr double kSquare = 0.05;  // [m]

Camera camera_at(glm::dvec3 position, double roll, double pitch) {
  Camera camera = distorted_camera();
  camera.intrinsics = {640, 480, {620.0, 610.0}, {325.0, 236.0}, {-0.2, 0.05, 0.0004, -0.0003, 0.0}};
  camera.exposure = camera.readout = 0.0;
  camera.position = position;
  // Looks at the board's centre, turned by `roll` about its axis and from the side by `pitch`.
  camera.forward = glm::normalize(glm::dvec3{std::sin(pitch), 0.0, 0.0} - position);
  const glm::dvec3 side = glm::normalize(glm::cross(camera.forward, glm::dvec3{std::sin(roll), std::cos(roll), 0.0}));
  camera.right = side;
  camera.down = glm::cross(camera.forward, side);
  return camera;
}

Scene chessboard() {
  Scene scene;
  scene.texture = 0.0;
  Patch board;
  board.shape = Patch::Shape::tag;
  board.size = glm::dvec2{kSquares * kSquare};
  board.pattern.cells = kSquares;
  for (int i = 0; i < kSquares * kSquares; ++i)
    board.pattern.white.push_back(static_cast<std::uint8_t>((i / kSquares + i % kSquares) % 2));
  scene.patches.push_back(board);
  return scene;
}

}  // namespace

TEST(Calibration, FindsTheIntrinsicsOfTheImages) {
  std::vector<Image> images;
  for (const glm::dvec3& position : {glm::dvec3{0.0, 0.0, 0.62},
                                     {0.35, 0.1, 0.6},
                                     {-0.35, 0.15, 0.6},
                                     {0.1, -0.4, 0.6},
                                     {-0.1, 0.4, 0.6},
                                     {0.3, 0.3, 0.7}}) {
    Image image;
    const Camera camera = camera_at(position, 0.2 * position.x, 0.1 * position.y);
    Renderer(camera, Imaging{}, images.size()).render(chessboard(), 0.0, 0, image);
    images.push_back(image);
  }
  images.emplace_back(Image{640, 480, 1, std::vector<std::uint8_t>(640 * 480, 99)});  // without a board
  const Calibration c = opencv().calibrate(images, kSquares - 1, kSquares - 1, kSquare);
  EXPECT_LT(c.residual, 0.1);
  EXPECT_GT(c.residual, 0.001);
  ASSERT_EQ(c.residuals.size(), 7u);
  EXPECT_TRUE(c.residuals[0]);
  EXPECT_FALSE(c.residuals[6]);
  const Intrinsics truth = camera_at({0.0, 0.0, 1.0}, 0.0, 0.0).intrinsics;
  EXPECT_NEAR(c.intrinsics.focal.x, truth.focal.x, 2.0);
  EXPECT_NEAR(c.intrinsics.focal.y, truth.focal.y, 2.0);
  EXPECT_NEAR(c.intrinsics.center.x, truth.center.x, 2.0);
  EXPECT_NEAR(c.intrinsics.center.y, truth.center.y, 2.0);
  EXPECT_NEAR(c.intrinsics.distortion[0], truth.distortion[0], 0.02);
}

TEST(Calibration, NeedsThreeImages) {
  const std::vector<Image> images(4, Image{64, 48, 1, std::vector<std::uint8_t>(64 * 48, 99)});
  try {
    opencv().calibrate(images, 9, 9, 0.05);
    FAIL();
  } catch (const base::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("found in 0 of 4 images; expected at least 3"), std::string::npos);
  }
}

}  // namespace sf::vision
