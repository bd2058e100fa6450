#include "world/outline.h"

#include <gtest/gtest.h>

namespace sf::world {
namespace {

double twice_area(const Outline& outline) {
  double sum = 0.0;
  for (const Edge& edge : outline.edges) sum += base::cross(edge.a, edge.b);
  return sum;
}

TEST(Outline, EitherWindingComesOutCounterClockwise) {
  const auto left = outline_of({{0, 0}, {2, 0}, {2, 1}, {0, 1}});
  const auto right = outline_of({{0, 1}, {2, 1}, {2, 0}, {0, 0}});
  EXPECT_TRUE(left.solid_left);
  EXPECT_TRUE(right.solid_left);
  EXPECT_EQ(twice_area(left), 4.0);
  EXPECT_EQ(twice_area(right), 4.0);
}

TEST(Outline, EdgesFollowEachOtherAndClose) {
  const auto outline = outline_of({{0, 0}, {2, 0}, {1, 2}});
  ASSERT_EQ(outline.edges.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(outline.edges[i].b.x, outline.edges[(i + 1) % 3].a.x);
    EXPECT_EQ(outline.edges[i].b.y, outline.edges[(i + 1) % 3].a.y);
  }
}

TEST(Outline, RepeatedCornersAreDropped) {
  const auto outline = outline_of({{0, 0}, {0, 0}, {2, 0}, {2, 1}, {2, 1}, {0, 0}});
  EXPECT_EQ(outline.edges.size(), 3u);
  EXPECT_TRUE(outline.solid_left);
}

TEST(Outline, NothingFromNoneOrOnePoint) {
  EXPECT_TRUE(outline_of({}).edges.empty());
  EXPECT_TRUE(outline_of({{1, 1}}).edges.empty());
  EXPECT_TRUE(outline_of({{1, 1}, {1, 1}, {1, 1}}).edges.empty());
}

TEST(Outline, TwoPointsAreOneWallWithoutSides) {
  const auto outline = outline_of({{0, 0}, {1, 0}});
  EXPECT_EQ(outline.edges.size(), 1u);
  EXPECT_FALSE(outline.solid_left);
}

TEST(Outline, ABowTieHasNoSides) { EXPECT_FALSE(outline_of({{0, 0}, {2, 2}, {2, 0}, {0, 1}}).solid_left); }

TEST(Outline, APolygonThatTouchesItselfInACornerHasNoSides) {
  EXPECT_FALSE(outline_of({{0, 0}, {2, 0}, {1, 1}, {2, 2}, {0, 2}, {1, 1}}).solid_left);
}

TEST(Outline, NoAreaNoSides) { EXPECT_FALSE(outline_of({{0, 0}, {1, 0}, {2, 0}}).solid_left); }

TEST(Outline, ASpikeThatFoldsBackHasNoSides) {
  EXPECT_FALSE(outline_of({{0, 0}, {2, 0}, {2, 2}, {2, 3}, {2, 1}, {0, 1}}).solid_left);
}

TEST(Outline, CornersOnAStraightEdgeAreFine) {
  const auto outline = outline_of({{0, 0}, {1, 0}, {2, 0}, {2, 2}, {0, 2}});
  EXPECT_TRUE(outline.solid_left);
  EXPECT_EQ(outline.edges.size(), 5u);
}

TEST(Outline, ConcaveIsSimple) { EXPECT_TRUE(outline_of({{0, 0}, {4, 0}, {4, 4}, {2, 1}, {0, 4}}).solid_left); }

}  // namespace
}  // namespace sf::world
