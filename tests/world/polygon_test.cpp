#include "world/stage/polygon.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace sf::world {
namespace {

double twice_area(const Polygon& outline) {
  double sum = 0.0;
  for (const PolygonEdge& edge : outline.edges) sum += base::cross(edge.a, edge.b);
  return sum;
}

TEST(Polygon, EitherWindingBecomesCounterClockwise) {
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

TEST(Polygon, NoneOrOnePointGivesNothing) {
  EXPECT_TRUE(make_polygon({}).edges.empty());
  EXPECT_TRUE(make_polygon({{1, 1}}).edges.empty());
  EXPECT_TRUE(make_polygon({{1, 1}, {1, 1}, {1, 1}}).edges.empty());
}

TEST(Polygon, TwoPointsAreOneWallWithoutSides) {
  const auto outline = make_polygon({{0, 0}, {1, 0}});
  EXPECT_EQ(outline.edges.size(), 1u);
  EXPECT_FALSE(outline.solid_left);
}

TEST(Polygon, ZeroAreaHasNoSides) { EXPECT_FALSE(make_polygon({{0, 0}, {1, 0}, {2, 0}}).solid_left); }

TEST(Polygon, CornersOnAStraightEdgeAreAccepted) {
  const auto outline = make_polygon({{0, 0}, {1, 0}, {2, 0}, {2, 2}, {0, 2}});
  EXPECT_TRUE(outline.solid_left);
  EXPECT_EQ(outline.edges.size(), 5u);
}

TEST(Polygon, CrossingsMatchATestOfAllPairs) {  // on a grid, where sides and betweenness are exact
  using P = glm::dvec2;
  const auto side = [](P a, P b, P p) { return base::cross(b - a, p - a); };
  const auto on = [&](P a, P b, P p) { return side(a, b, p) == 0.0 && dot(a - p, b - p) <= 0.0; };
  const auto meet = [&](P a, P b, P c, P d) {
    return (side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0) || on(a, b, c) || on(a, b, d) ||
           on(c, d, a) || on(c, d, b);
  };
  std::mt19937 random(7);
  int simple = 0;
  for (int run = 0; run < 5000; ++run) {
    std::vector<P> p(3 + random() % 6);
    for (P& corner : p) corner = {static_cast<double>(random() % 6), static_cast<double>(random() % 6)};
    const std::size_t n = p.size();
    double area = 0.0;
    bool expected = true;
    for (std::size_t i = 0; i < n; ++i) {
      const P a = p[i], b = p[(i + 1) % n], c = p[(i + 2) % n];
      area += base::cross(a, b);
      if (a == b || (side(a, b, c) == 0.0 && dot(b - a, c - b) < 0.0)) expected = false;
      for (std::size_t j = i + 2; j < n; ++j)
        if ((j + 1) % n != i && meet(a, b, p[j], p[(j + 1) % n])) expected = false;
    }
    const bool repeats = std::adjacent_find(p.begin(), p.end()) != p.end() || p.front() == p.back();
    if (repeats || area == 0.0) continue;
    EXPECT_EQ(make_polygon(p).solid_left, expected) << run;
    simple += expected;
  }
  EXPECT_GT(simple, 500);
}

TEST(Polygon, WorkIsBounded) {  // pairs that overlap along x; in a square, each edge overlaps all others
  const std::vector<glm::dvec2> square{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  double pairs = 6.0;
  EXPECT_TRUE(make_polygon(square, pairs).has_value());
  EXPECT_EQ(pairs, 1.0) << "but the two upright ones";
  EXPECT_FALSE(make_polygon(square, pairs).has_value());
  EXPECT_EQ(pairs, 1.0) << "nothing is charged for what is not done";
}

}  // namespace
}  // namespace sf::world
