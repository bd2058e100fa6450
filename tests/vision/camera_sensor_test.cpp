// Images of the camera sensor for vision code: corners of a chessboard, found by OpenCV, are on straight lines once
// they are undistorted, and tags are where the positioning system finds them.

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>

#include "base/elementary.h"
#include "base/lens.h"
#include "sensors/camera.h"
#include "tests/sensors/series.h"
#include "tests/units.h"
#include "vision/opencv.h"
#include "vision/tag_detector.h"
#include "vision/tag_family.h"

namespace sf::vision {
namespace {

constexpr Chessboard kChessboard{8, 6, 0.2};
constexpr int kWidth = 640, kHeight = 480;

/// The image of a world's only camera, in grey.
Image photograph_world(const std::string& text) {
  const world::World world = trial::world_of(text);
  farm::Farm farm(world, host_device(), {.noise = false, .threads = 2});
  const base::ReadingBlock r = farm.sense(0, sensors::kCamera, 0, {});
  Image image{kWidth, kHeight, 1, {}};
  for (std::size_t i = 1; i < r.values.size(); i += 2)
    image.pixels.push_back(static_cast<std::uint8_t>(static_cast<std::uint32_t>(r.values[i]) & 255u));
  return image;
}

/// A board 2 m ahead of a camera, on a white plate, without shadows; its squares are boxes with a common front.
Image photograph(const std::string& lens) {
  std::string text =
      "sunlight 0 skylight 1\n"
      "model( pose [2.03 0 0.1 0] size [0.02 2.2 1.8] color \"white\" )\n"
      "position( size [0.4 0.4 0.5] origin [0 0 0 0] camera( resolution [640 480] rgb 1 samples 8 pose6 [0 0 0.45 0 0 "
      "0] " +
      lens + " ) )\n";
  for (int row = 0; row <= kChessboard.rows; ++row)
    for (int column = 0; column <= kChessboard.columns; ++column)
      text += fmt::format("model( pose [2.01 {:.1f} {:.1f} 0] size [0.02 0.2 0.2] color \"{}\" )\n", 0.2 * column - 0.8,
                          0.2 * row + 0.3, (row + column) % 2 == 0 ? "black" : "white");
  return photograph_world(text);
}

/// Largest distance of points from the line through the first and the last.
double bend(const std::vector<glm::dvec2>& points) {
  const glm::dvec2 along = glm::normalize(points.back() - points.front());
  double most = 0.0;
  for (const glm::dvec2& p : points) {
    const glm::dvec2 from = p - points.front();
    most = std::max(most, std::abs(from.x * along.y - from.y * along.x));
  }
  return most;
}

/// [px] of the rows and columns of a board. @param corners row by row
double bend_of_lines(const std::vector<glm::dvec2>& corners) {
  double most = 0.0;
  for (int row = 0; row < kChessboard.rows; ++row) {
    const auto first = corners.begin() + row * kChessboard.columns;
    most = std::max(most, bend({first, first + kChessboard.columns}));
  }
  for (int column = 0; column < kChessboard.columns; ++column) {
    std::vector<glm::dvec2> line;
    for (int row = 0; row < kChessboard.rows; ++row)
      line.push_back(corners[static_cast<std::size_t>(row * kChessboard.columns + column)]);
    most = std::max(most, bend(line));
  }
  return most;
}

TEST(CameraSensor, UndistortedChessboardsHaveStraightLines) {
  const struct {
    const char* keys;
    base::Lens lens;
  } kLenses[] = {
      {"focal [560 550] principal [325 236] distortion [-0.3 0.08 0.002 -0.001]",
       {{560, 550}, {325, 236}, {-0.3, 0.08, 0.002, -0.001}, false}},
      {"focal 450 fisheye [-0.05 0.01 0 0]", {{450, 450}, {319.5, 239.5}, {-0.05, 0.01}, true}},
  };
  for (const auto& [keys, lens] : kLenses) {
    const std::vector<BoardCorner> found = opencv().find_board(photograph(keys), kChessboard);
    ASSERT_EQ(found.size(), 48u) << keys;
    const base::LensImage image(lens, kWidth, kHeight);
    std::vector<glm::dvec2> bent, straight;
    for (const BoardCorner& corner : found) {
      bent.push_back(corner.pixel);
      straight.push_back(lens.center + lens.focal * image.direction(corner.pixel).value());
    }
    EXPECT_GT(bend_of_lines(bent), 2.0) << keys;
    EXPECT_LT(bend_of_lines(straight), 0.4) << keys << ": as well as corners are found";
  }
}

/// A printed tag with a white margin of one cell, as the top of two models: black cells and white ones.
std::string tag_models(std::uint32_t id, double side, const base::Pose& X_WT) {
  const TagPattern pattern = family_pattern("apriltag_36h11", id);
  std::string text;
  for (const bool white : {true, false}) {
    const int margin = white ? 1 : 0, cells = pattern.cells + 2 * margin;
    const double size = side * cells / pattern.cells;
    text += fmt::format("model( pose [{} {} 0 {}] size [{} {} 0.2] color \"{}\"\n", X_WT.x, X_WT.y, X_WT.yaw / kDegree,
                        size, size, white ? "white" : "black");
    for (int y = 0; y < cells; ++y)
      for (int x = 0; x < cells; ++x) {
        const int row = y - margin, column = x - margin;
        const bool inside = row >= 0 && row < pattern.cells && column >= 0 && column < pattern.cells;
        if ((!inside || pattern.white[static_cast<std::size_t>(row * pattern.cells + column)] != 0) == white)
          text += fmt::format(
              "block( points 4 point[0] [{0} {1}] point[1] [{2} {1}] point[2] [{2} {3}] point[3] [{0} {3}] z [0 1] )\n",
              x, cells - y - 1, x + 1, cells - y);
      }
    text += ")\n";
  }
  return text;
}

TEST(CameraSensor, TagsAreWhereThePositioningSystemFindsThem) {
  Testbed testbed;
  testbed.tag = {.side = 0.15, .height = 0.2};
  Camera camera;
  camera.intrinsics = {kWidth, kHeight, {832, 832}, {322.6, 236.3}, {-0.18, 0.06, 0.0005, -0.0004, 0.0}};
  camera.position = {0, 0.05, 3.3};  // 5 cm along its own z from its mount, which is on the robot
  // Looks down with its right along x, on a robot without a body that could be seen.
  std::string text =
      "sunlight 0 skylight 1 floor_color \"gray60\"\n"
      "position( obstacle_return 0 size [0.1 0.1 0.1] origin [0 0 0 0] camera( resolution [640 480] pose6 [0 0 3.2 0 "
      "90 "
      "90] mono 1 linear 1 samples 12 blur 0.6 focal [832 832] principal [322.6 236.3] "
      "distortion [-0.18 0.06 0.0005 -0.0004 0] ) )\n";
  std::map<std::uint32_t, base::Pose> tags;
  for (std::uint32_t id = 0; id < 6; ++id) {
    tags[id] = {0.7 * (id % 3) - 0.69, 0.8 * (id / 3) - 0.41, 0.2, 0.4 * id - 1.1};
    text += tag_models(id, testbed.tag.side, tags[id]);
  }
  std::vector<Sighting> found;
  TagDetector(testbed, camera).detect(photograph_world(text), 0.0, found);
  ASSERT_EQ(found.size(), tags.size());
  for (const Sighting& tag : found) {
    const base::Pose &X = tag.fit.X_WT, &truth = tags[tag.id];
    EXPECT_LT(base::hypot(X.x - truth.x, X.y - truth.y), 0.15e-3) << tag.id;
    EXPECT_LT(std::abs(base::wrap_angle(X.yaw - truth.yaw)), 0.25 * kDegree) << tag.id;
  }
}

}  // namespace
}  // namespace sf::vision
