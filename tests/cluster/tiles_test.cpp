#include "cluster/tiles.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <vector>

namespace sf::cluster {

namespace {

using Points = std::vector<glm::dvec2>;

std::vector<unsigned> counts_of(const Tiles& tiles, const Points& points) {
  std::vector<unsigned> counts(tiles.size());
  for (const glm::dvec2& p : points) ++counts[tiles.at(p)];
  return counts;
}

TEST(Tiles, SingleTileIsThePlane) {
  const Tiles tiles(Points{{1, 2}}, std::vector<double>{1}, 1);
  EXPECT_EQ(tiles.at({-1e9, 1e9}), 0u);
  EXPECT_EQ(tiles.distance(0, {-1e9, 1e9}), 0.0);
}

TEST(Tiles, CutsAcrossTheLongerSide) {
  const Tiles tiles(Points{{0, 0}, {1, 9}}, std::vector<double>{1, 1}, 2);
  EXPECT_EQ(tiles.at({100, 4.4}), 0u);
  EXPECT_EQ(tiles.at({-100, 4.6}), 1u);
}

TEST(Tiles, EdgeBelongsToTheUpperTile) {
  const Tiles tiles(Points{{0, 0}, {2, 0}}, std::vector<double>{1, 1}, 2);
  EXPECT_EQ(tiles.at({1, 0}), 1u);
  EXPECT_EQ(tiles.at({std::nextafter(1.0, 0.0), 0}), 0u);
}

TEST(Tiles, BalancesCostsNotPoints) {
  const Points points{{0, 0}, {1, 0}, {2, 0}, {3, 0}};
  EXPECT_EQ(counts_of(Tiles(points, std::vector<double>{3, 1, 1, 1}, 2), points), (std::vector<unsigned>{1, 3}));
}

TEST(Tiles, OddNumberOfTilesIsBalanced) {
  Points points;
  for (int i = 0; i < 30; ++i) points.push_back({i, 0});
  EXPECT_EQ(counts_of(Tiles(points, std::vector<double>(30, 1.0), 3), points), (std::vector<unsigned>{10, 10, 10}));
}

TEST(Tiles, PointsAtOnePlaceStayTogether) {
  const Points points(5, {1, 1});
  const Tiles tiles(points, std::vector<double>(5, 1.0), 4);
  const auto counts = counts_of(tiles, points);
  EXPECT_EQ(*std::max_element(counts.begin(), counts.end()), 5u);
}

TEST(Tiles, NoPoints) {  // a world without robots
  const Tiles tiles({}, {}, 5);
  EXPECT_LT(tiles.at({3, 4}), 5u);
}

TEST(Tiles, EveryPointIsInExactlyOneTile) {
  EXPECT_TRUE(rc::check([](std::vector<std::pair<int, int>> places, std::uint8_t ranks, int x, int y) {
    Points points;
    for (const auto& [a, b] : places) points.push_back({a, b});
    const Tiles tiles(points, std::vector<double>(points.size(), 1.0), 1 + ranks % 9);
    const glm::dvec2 p{x, y};
    RC_ASSERT(tiles.distance(tiles.at(p), p) == 0.0);
    for (unsigned k = 0; k < tiles.size(); ++k) {
      const base::Box& box = tiles[k];
      const bool inside = box.min.x <= p.x && p.x < box.max.x && box.min.y <= p.y && p.y < box.max.y;
      RC_ASSERT(inside == (k == tiles.at(p)));
    }
  }));
}

TEST(Tiles, DistanceIsToTheNearestPoint) {
  const Tiles tiles(Points{{0, 0}, {10, 0}, {0, 10}, {10, 10}}, std::vector<double>(4, 1.0), 4);
  const unsigned far = tiles.at({10, 10});
  EXPECT_DOUBLE_EQ(tiles.distance(far, {2, 1}), 5.0);  // 3 and 4 to its corner at (5, 5)
  EXPECT_DOUBLE_EQ(tiles.distance(far, {7, 1}), 4.0);
}

}  // namespace

}  // namespace sf::cluster
