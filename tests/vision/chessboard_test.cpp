// The camera sensor's lens against OpenCV: corners of a chessboard, found in its image, are on straight lines once they
// are undistorted.

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/lens.h"
#include "sensors/camera.h"
#include "tests/sensors/series.h"
#include "vision/opencv.h"

namespace sf::vision {
namespace {

constexpr Chessboard kChessboard{8, 6, 0.2};
constexpr int kWidth = 640, kHeight = 480;

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
  const world::World world = trial::world_of(text);
  farm::Farm farm(world, host_device(), {.noise = false, .threads = 2});
  const base::ReadingBlock r = farm.sense(0, sensors::kCamera, 0, {});
  Image image{kWidth, kHeight, 1, {}};
  for (std::size_t i = 1; i < r.values.size(); i += 2)
    image.pixels.push_back(static_cast<std::uint8_t>(static_cast<std::uint32_t>(r.values[i]) & 255u));
  return image;
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

}  // namespace
}  // namespace sf::vision
