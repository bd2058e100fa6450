#include "world/stage/polygon.h"

#include <gtest/gtest.h>

namespace sf::world {
namespace {

double twice_area(const Polygon& outline) {
  double sum = 0.0;
  for (const PolygonEdge& edge : outline.edges) sum += base::cross(edge.a, edge.b);
  return sum;
}

TEST(Polygon, EitherWindingComesOutCounterClockwise) {
  const auto left = make_polygon({{0, 0}, {2, 0}, {2, 1}, {0, 1}});
  const auto right = make_polygon({{0, 1}, {2, 1}, {2, 0}, {0, 0}});
  EXPECT_TRUE(left.solid_left);
  EXPECT_TRUE(right.solid_left);
  EXPECT_EQ(twice_area(left), 4.0);
  EXPECT_EQ(twice_area(right), 4.0);
}

TEST(Polygon, EdgesFollowEachOtherAndClose) {
  const auto outline = make_polygon({{0, 0}, {2, 0}, {1, 2}});
  ASSERT_EQ(outline.edges.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(outline.edges[i].b.x, outline.edges[(i + 1) % 3].a.x);
    EXPECT_EQ(outline.edges[i].b.y, outline.edges[(i + 1) % 3].a.y);
  }
}

TEST(Polygon, RepeatedCornersAreDropped) {
  const auto outline = make_polygon({{0, 0}, {0, 0}, {2, 0}, {2, 1}, {2, 1}, {0, 0}});
  EXPECT_EQ(outline.edges.size(), 3u);
  EXPECT_TRUE(outline.solid_left);
}

TEST(Polygon, NothingFromNoneOrOnePoint) {
  EXPECT_TRUE(make_polygon({}).edges.empty());
  EXPECT_TRUE(make_polygon({{1, 1}}).edges.empty());
  EXPECT_TRUE(make_polygon({{1, 1}, {1, 1}, {1, 1}}).edges.empty());
}

TEST(Polygon, TwoPointsAreOneWallWithoutSides) {
  const auto outline = make_polygon({{0, 0}, {1, 0}});
  EXPECT_EQ(outline.edges.size(), 1u);
  EXPECT_FALSE(outline.solid_left);
}

TEST(Polygon, ABowTieHasNoSides) { EXPECT_FALSE(make_polygon({{0, 0}, {2, 2}, {2, 0}, {0, 1}}).solid_left); }

TEST(Polygon, APolygonThatTouchesItselfInACornerHasNoSides) {
  EXPECT_FALSE(make_polygon({{0, 0}, {2, 0}, {1, 1}, {2, 2}, {0, 2}, {1, 1}}).solid_left);
}

TEST(Polygon, NoAreaNoSides) { EXPECT_FALSE(make_polygon({{0, 0}, {1, 0}, {2, 0}}).solid_left); }

TEST(Polygon, ASpikeThatFoldsBackHasNoSides) {
  EXPECT_FALSE(make_polygon({{0, 0}, {2, 0}, {2, 2}, {2, 3}, {2, 1}, {0, 1}}).solid_left);
}

TEST(Polygon, CornersOnAStraightEdgeAreFine) {
  const auto outline = make_polygon({{0, 0}, {1, 0}, {2, 0}, {2, 2}, {0, 2}});
  EXPECT_TRUE(outline.solid_left);
  EXPECT_EQ(outline.edges.size(), 5u);
}

TEST(Polygon, ConcaveIsSimple) { EXPECT_TRUE(make_polygon({{0, 0}, {4, 0}, {4, 4}, {2, 1}, {0, 4}}).solid_left); }

}  // namespace
}  // namespace sf::world
