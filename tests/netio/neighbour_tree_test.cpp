#include "netio/neighbour_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

namespace sf::netio {
namespace {

using Rows = std::vector<std::uint32_t>;
using Places = std::vector<NeighbourTree::Place>;

Rows rows_of(std::span<const std::uint32_t> rows) { return {rows.begin(), rows.end()}; }

/// Reference: all distances.
Rows nearest(const Places& places, const NeighbourTree::Query& query) {
  Places all = places;
  const auto square = [&](const NeighbourTree::Place& q) { return dot(q.p - *query.p, q.p - *query.p); };
  std::erase_if(all, [&](const auto& q) {
    return q.row == query.own || q.age > query.max_age || square(q) > query.range * query.range;
  });
  std::sort(all.begin(), all.end(), [&](const auto& a, const auto& b) { return square(a) < square(b); });
  all.resize(std::min(all.size(), query.max_count));
  Rows rows;
  for (const auto& q : all) rows.push_back(q.row);
  return rows;
}

/// In a square, along a street to the north (equal x), and along one to the east.
TEST(NeighbourTree, FindsTheNearest) {
  std::mt19937 random(5);  // NOLINT: the same every time
  std::uniform_real_distribution<double> anywhere(-50.0, 50.0);
  for (const glm::dvec2& street : {glm::dvec2{1, 1}, glm::dvec2{0, 1}, glm::dvec2{1, 0}}) {
    Places places;
    for (std::uint32_t row = 0; row < 2000; ++row)
      places.push_back({{street.x * anywhere(random), street.y * anywhere(random)}, row, row % 3});
    NeighbourTree tree(places.size());
    tree.build(places);
    for (std::uint32_t own = 0; own < 2000; own += 37)
      for (const std::size_t max_count : {1u, 5u, 64u})
        for (const double range : {3.0, 200.0})
          for (const std::uint32_t max_age : {1u, 2u}) {
            const NeighbourTree::Query query{places[own].p, own, range, max_count, max_age};
            EXPECT_EQ(rows_of(tree.find(query)), nearest(places, query)) << own << " of " << max_count;
          }
  }
}

/// If all robots are at one place, each has neighbours, never itself, and not all robots have the same ones.
TEST(NeighbourTree, CrowdAtOnePlace) {
  Places places;
  for (std::uint32_t row = 0; row < 5000; ++row) places.push_back({{1.0, 2.0}, row});
  NeighbourTree tree(places.size());
  tree.build(places);
  std::set<std::uint32_t> found;
  for (std::uint32_t own = 0; own < 5000; own += 100) {
    const Rows rows = rows_of(tree.find({places[own].p, own, 5.0, 8}));
    EXPECT_EQ(std::set(rows.begin(), rows.end()).size(), 8u);
    EXPECT_EQ(std::count(rows.begin(), rows.end(), own), 0);
    found.insert(rows.begin(), rows.end());
  }
  EXPECT_GT(found.size(), 100u);
  EXPECT_LE(tree.visits(), 50u * 40u);
}

/// The worst case for the tree: all places at about the same distance.
TEST(NeighbourTree, CrowdOnACircleIsBounded) {
  Places places;
  for (std::uint32_t row = 0; row < 5000; ++row) places.push_back({{std::cos(row), std::sin(row)}, row});
  NeighbourTree tree(places.size());
  tree.build(places);
  EXPECT_EQ(tree.find({glm::dvec2{}, 9999, 5.0, 8}).size(), 8u);
  EXPECT_LE(tree.visits(), NeighbourTree::kMaxVisits);
}

TEST(NeighbourTree, OldPlacesAreBounded) {
  Places places;
  for (std::uint32_t row = 0; row < 2000; ++row) places.push_back({{0.0, 0.0}, row, 1});
  NeighbourTree tree(places.size());
  tree.build(places);
  EXPECT_TRUE(tree.find({.own = 0, .range = 1.0, .max_count = 1}).empty());
  EXPECT_EQ(tree.visits(), NeighbourTree::kMaxVisits);
}

TEST(NeighbourTree, ReturnsAnyRowsWithoutACentre) {
  const Places places{{{0, 0}, 0}, {{1e7, 0}, 1}, {{0, -1e7}, 2}, {{5, 5}, 3, 1}};
  NeighbourTree tree(places.size());
  tree.build(places);
  std::set<std::uint32_t> found;
  for (int i = 0; i < 4; ++i) {
    const Rows rows = rows_of(tree.find({.own = 0, .range = 1.0, .max_count = 1}));
    ASSERT_EQ(rows.size(), 1u);
    found.insert(rows[0]);
  }
  EXPECT_EQ(found, (std::set<std::uint32_t>{1, 2})) << "neither itself nor old places";
  tree.build({});
  EXPECT_TRUE(tree.find({.own = 0, .range = 1.0, .max_count = 1}).empty());
  EXPECT_TRUE(tree.find({glm::dvec2{}, 0, 1.0, 1}).empty());
}

}  // namespace
}  // namespace sf::netio
