// Lanes of exact straight lines and arcs.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/world/read_world.h"

namespace sf::world {
namespace {

constexpr const char* kThesis = R"(path( pose [1 2 0 0] pieces 3
  straight[0] [2.72 0.50] arc[1] [0.93 90 0.60] straight[2] [1.349 0.45]
  left "solid_white" right "solid_yellow" paint_width 0.02
  magnetic_moment 10000 magnet_spacing 0.071 magnet_size [0.025 0.1] ))";

TEST(Path, KeepsItsPieces) {
  const World world = read_world(kThesis);
  ASSERT_EQ(world.paths.size(), 1u);
  const Path& path = world.paths[0];
  EXPECT_EQ(path.name, "path");
  ASSERT_EQ(path.pieces.size(), 3u);
  EXPECT_EQ(path.pieces[0].curvature, 0.0);
  EXPECT_DOUBLE_EQ(path.pieces[1].curvature, 1.0 / 0.93);
  EXPECT_DOUBLE_EQ(path.pieces[1].length, 0.93 * M_PI / 2);
  EXPECT_EQ(path.pieces[2].width, 0.45);
  EXPECT_DOUBLE_EQ(path.pieces[2].X_WP.x, 1.0 + 2.72 + 0.93);
  EXPECT_DOUBLE_EQ(path.pieces[2].X_WP.y, 2.0 + 0.93);
  EXPECT_DOUBLE_EQ(path.pieces[2].X_WP.yaw, M_PI / 2);
  EXPECT_LT(read_world("path( pieces 1 arc[0] [1 -90 0.5] )").paths[0].pieces[0].curvature, 0.0) << "to the right";
}

TEST(Path, PaintIsOutsideTheLane) {
  const World world = read_world(kThesis);
  ASSERT_EQ(world.lane_markings.size(), 6u);
  const LaneMarking& left = world.lane_markings[0];
  ASSERT_EQ(left.line.size(), 2u) << "a straight is two points";
  EXPECT_DOUBLE_EQ(left.line[0].x, 1.0);
  EXPECT_DOUBLE_EQ(left.line[0].y, 2.0 + 0.25 + 0.01);
  EXPECT_DOUBLE_EQ(left.line[1].x, 3.72);
  EXPECT_EQ(left.color, 0xFFFFFFFFu);
  EXPECT_EQ(world.lane_markings[1].color, 0xFFFFCC00u);
}

TEST(Path, ArcsAreWithinAMicrometre) {
  const World world = read_world(kThesis);
  const glm::dvec2 centre{3.72, 2.93};
  for (const std::size_t side : {2u, 3u}) {
    const double radius = 0.93 + (side == 2 ? -1.0 : 1.0) * 0.31;
    const auto& line = world.lane_markings[side].line;
    for (std::size_t i = 0; i < line.size(); ++i) EXPECT_NEAR(length(line[i] - centre), radius, 1e-12);
    for (std::size_t i = 1; i < line.size(); ++i) {
      const double middle = length(0.5 * (line[i] + line[i - 1]) - centre);
      EXPECT_LT(radius - middle, 1e-6);
      EXPECT_GT(radius - middle, 1e-8) << "no more chords than are needed";
    }
  }
}

TEST(Path, PiecesAreConnected) {
  const World world = read_world(kThesis);
  const auto& last = world.lane_markings[4].line;
  EXPECT_NEAR(last[0].x, 3.72 + 0.93 - 0.235, 1e-12);
  EXPECT_NEAR(last[0].y, 2.93, 1e-12);
  EXPECT_NEAR(last[1].y, 2.93 + 1.349, 1e-12);
}

TEST(Path, MagnetsKeepTheirSpacingAlongTheMiddle) {
  const World world = read_world(kThesis);
  const double total = 2.72 + 0.93 * M_PI / 2 + 1.349;
  ASSERT_EQ(world.magnets.size(), static_cast<std::size_t>(total / 0.071) + 1);
  for (std::size_t k = 0; k < world.magnets.size(); ++k) {
    const Magnet& m = world.magnets[k];
    EXPECT_EQ(m.moment, 1.0);
    EXPECT_DOUBLE_EQ(m.z, -0.05) << "their tops are level with the ground";
    EXPECT_DOUBLE_EQ(m.radius, 0.0125);
    const double s = 0.071 * static_cast<double>(k);
    if (s < 2.72) {
      EXPECT_NEAR(m.p.x, 1.0 + s, 1e-12);
    } else if (s < 2.72 + 0.93 * M_PI / 2) {
      EXPECT_NEAR(length(m.p - glm::dvec2{3.72, 2.93}), 0.93, 1e-12);
    } else {
      EXPECT_NEAR(m.p.x, 4.65, 1e-12);
    }
  }
}

TEST(Path, DashesContinueFromPieceToPiece) {
  const World world =
      read_world(R"(path( pieces 2 straight[0] [1 0.5] straight[1] [1 0.5] right "broken_white" dash [0.3 0.4] ))");
  std::vector<std::pair<double, double>> dashes;
  for (const LaneMarking& stripe : world.lane_markings)
    dashes.emplace_back(stripe.line.front().x, stripe.line.back().x);
  const std::vector<std::pair<double, double>> expected{{0.0, 0.3}, {0.7, 1.0}, {1.4, 1.7}};
  ASSERT_EQ(dashes.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(dashes[i].first, expected[i].first, 1e-12);
    EXPECT_NEAR(dashes[i].second, expected[i].second, 1e-12);
  }
}

TEST(Path, DashMaySpanTwoPieces) {
  const World world =
      read_world(R"(path( pieces 2 straight[0] [1 0.5] straight[1] [1 0.5] left "broken_white" dash [0.8 0.15] ))");
  ASSERT_EQ(world.lane_markings.size(), 4u);  // 0..0.8, 0.95..1 | 1..1.75, 1.9..2
  EXPECT_NEAR(world.lane_markings[2].line.back().x, 1.75, 1e-12);
}

TEST(Path, DoubleLineIsTwoStripes) {
  const World world = read_world(R"(path( pieces 1 straight[0] [1 0.5] left "double_yellow" paint_width 0.02 ))");
  ASSERT_EQ(world.lane_markings.size(), 2u);
  EXPECT_NEAR(world.lane_markings[0].line[0].y, 0.26, 1e-12);
  EXPECT_NEAR(world.lane_markings[1].line[0].y, 0.30, 1e-12);
}

TEST(Path, ErrorsNameTheirLine) {
  EXPECT_EQ(error_of("path( )"), "test.world:1: a path requires 'pieces', and a straight[i] or an arc[i] for each");
  EXPECT_EQ(error_of("path( pieces 2\nstraight[0] [1 1] )"),
            "test.world:1: expected either straight[1] or arc[1]: 'pieces' is 2");
  EXPECT_EQ(error_of("path( pieces 1 straight[0] [1 1] arc[0] [1 90 1] )"),
            "test.world:1: expected either straight[0] or arc[0]: 'pieces' is 1");
  EXPECT_EQ(error_of("path( pieces 1\narc[0] [0.2 90 0.5] )"),
            "test.world:2: 'arc[0]' is wider than its bend: expected a width below twice the radius");
  EXPECT_EQ(error_of("path( pieces 1\narc[0] [0.26 90 0.5] )"), "") << "nearly twice";
  EXPECT_EQ(error_of("path( pieces 1 straight[0] [1 1]\nleft \"dashed\" )"),
            "test.world:2: 'left' is \"dashed\"; expected \"double_yellow\", \"solid_yellow\", \"solid_white\", "
            "\"broken_white\" or \"none\"");
  EXPECT_EQ(error_of("path( pieces 1 straight[0] [1e7 1] left \"broken_white\"\ndash [1e-6 1e-6] )"),
            "test.world:2: 'dash' gives more than 1000000 dashes; expected longer ones");
  EXPECT_EQ(error_of("path( pieces 1 straight[0] [1 1] magnetic_moment 1 )"),
            "test.world:1: magnets require both a 'magnetic_moment' other than 0 and a 'magnet_spacing' above zero");
  EXPECT_EQ(error_of("model(\npath( pieces 1 straight[0] [1 1] ) )"),
            "test.world:2: 'path' is part of a model; expected it at the top level");
}

}  // namespace
}  // namespace sf::world
