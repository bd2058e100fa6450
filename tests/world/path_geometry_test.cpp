#include "world/path_geometry.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "tests/world/read_world.h"

namespace sf::world {
namespace {

Path lane() {
  return read_world(R"(path( pose [1 2 0 30] pieces 4
    straight[0] [1.5 0.5] arc[1] [0.93 90 0.6] arc[2] [0.7 -200 0.5] straight[3] [2 0.45] ))")
      .paths.at(0);
}

TEST(Along, PiecesJoinInPlaceAndDirection) {
  const Path path = lane();
  for (std::size_t i = 0; i + 1 < path.pieces.size(); ++i) {
    const Pose end = pose_at(path.pieces[i], path.pieces[i].length);
    EXPECT_NEAR(end.x, path.pieces[i + 1].X_WP.x, 1e-12);
    EXPECT_NEAR(end.y, path.pieces[i + 1].X_WP.y, 1e-12);
    EXPECT_NEAR(end.yaw, path.pieces[i + 1].X_WP.yaw, 1e-12);
  }
  EXPECT_NEAR(length_of(path), 1.5 + 0.93 * M_PI / 2 + 0.7 * M_PI * 200 / 180 + 2.0, 1e-12);
}

TEST(Along, AdvancesOneMetrePerMetre) {
  const Path path = lane();
  const double step = 1e-4;
  for (double s = -0.5; s < length_of(path) + 0.5; s += 0.01) {
    const Pose a = pose_at(path, s), b = pose_at(path, s + step);
    EXPECT_NEAR(std::hypot(b.x - a.x, b.y - a.y), step, 1e-11) << s;
    const glm::dvec2 ahead = base::rotate(a.yaw, {1.0, 0.0});
    EXPECT_NEAR(dot(ahead, glm::dvec2{b.x - a.x, b.y - a.y}), step, 1e-11) << "x is along it";
  }
}

TEST(Along, ArcIsACircle) {
  const Path path = read_world("path( pieces 1 arc[0] [2 -180 0.5] )").paths.at(0);
  for (double s = 0.0; s < length_of(path); s += 0.1) {
    const Pose X = pose_at(path, s);
    EXPECT_NEAR(std::hypot(X.x, X.y + 2.0), 2.0, 1e-12) << "about a point on its right";
  }
}

TEST(Nearest, OffsetIsTheDistanceFromThePath) {
  const Path path = lane();
  for (double s = 0.0; s < length_of(path); s += 0.037)
    for (const double offset : {-0.3, -0.01, 0.0, 0.2}) {
      const PathProjection on = project_onto(path, transform(pose_at(path, s), {0.0, offset}));
      EXPECT_NEAR(on.s, s, 1e-9);
      EXPECT_NEAR(on.offset, offset, 1e-9);
      EXPECT_NEAR(base::wrap_angle(on.X_WP.yaw - pose_at(path, s).yaw), 0.0, 1e-9);
    }
}

/// Boundary: the direction opposite the middle of an arc's remaining turn, 225 degrees from the start of a quarter
/// turn.
TEST(Nearest, BehindAnArcIsItsNearerEnd) {
  const Path path = read_world("path( pieces 1 arc[0] [1 90 0.5] )").paths.at(0);
  const auto at = [&](double degrees) {  // 2 m from the arc's centre, which is at (0, 1)
    const double angle = degrees * M_PI / 180.0;
    return project_onto(path, {2.0 * std::sin(angle), 1.0 - 2.0 * std::cos(angle)}).s;
  };
  EXPECT_NEAR(at(224.9), length_of(path), 1e-12);
  EXPECT_NEAR(at(225.1), 0.0, 1e-12);
  EXPECT_NEAR(at(260.0), 0.0, 1e-12);
}

TEST(Nearest, BeyondTheEndsIsTheEnd) {
  const Path path = lane();
  EXPECT_EQ(project_onto(path, transform(pose_at(path, 0.0), {-1.0, 0.3})).s, 0.0);
  const double length = length_of(path);
  const PathProjection beyond = project_onto(path, transform(pose_at(path, length), {1.0, 0.0}));
  EXPECT_NEAR(beyond.s, length, 1e-12);
  EXPECT_EQ(beyond.piece, 3u);
}

TEST(Nearest, NoPointOfThePathIsCloser) {
  const Path path = lane();
  const double length = length_of(path);
  for (std::uint32_t k = 0; k < 300; ++k) {
    const auto u = base::random_uniform({.seed = 4, .stream = base::RandomStream::placement, .a = k}, 0);
    const glm::dvec2 p{8.0 * u[0] - 1.0, 8.0 * u[1]};
    double least = HUGE_VAL;
    for (double s = 0.0; s <= length; s += 0.002) {
      const Pose X = pose_at(path, s);
      least = std::min(least, std::hypot(p.x - X.x, p.y - X.y));
    }
    const PathProjection on = project_onto(path, p);
    EXPECT_LE(std::abs(on.offset), least + 1e-12);
    EXPECT_NEAR(std::hypot(p.x - on.X_WP.x, p.y - on.X_WP.y), std::abs(on.offset), 1e-12);
  }
}

}  // namespace
}  // namespace sf::world
