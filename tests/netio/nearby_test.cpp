#include "netio/nearby.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

namespace sf::netio {
namespace {

using Rows = std::vector<std::uint32_t>;
using Places = std::vector<Nearby::Place>;

Rows rows_of(std::span<const std::uint32_t> rows) { return {rows.begin(), rows.end()}; }

/// By all distances.
Rows nearest(const Places& places, const Nearby::Query& query) {
  Places all = places;
  const auto square = [&](const Nearby::Place& q) { return dot(q.p - *query.p, q.p - *query.p); };
  std::erase_if(all, [&](const auto& q) {
    return q.row == query.own || q.age > query.oldest || square(q) > query.range * query.range;
  });
  std::sort(all.begin(), all.end(), [&](const auto& a, const auto& b) { return square(a) < square(b); });
  all.resize(std::min(all.size(), query.most));
  Rows rows;
  for (const auto& q : all) rows.push_back(q.row);
  return rows;
}

/// Everywhere; along a street northwards, where x says nothing; and along one eastwards.
TEST(Nearby, FindsTheNearest) {
  std::mt19937 random(5);  // NOLINT: the same every time
  std::uniform_real_distribution<double> anywhere(-50.0, 50.0);
  for (const glm::dvec2& street : {glm::dvec2{1, 1}, glm::dvec2{0, 1}, glm::dvec2{1, 0}}) {
    Places places;
    for (std::uint32_t row = 0; row < 2000; ++row)
      places.push_back({{street.x * anywhere(random), street.y * anywhere(random)}, row, row % 3});
    Nearby nearby(places.size());
    nearby.build(places);
    for (std::uint32_t own = 0; own < 2000; own += 37)
      for (const std::size_t most : {1u, 5u, 64u})
        for (const double range : {3.0, 200.0})
          for (const std::uint32_t oldest : {1u, 2u}) {
            const Nearby::Query query{places[own].p, own, range, most, oldest};
            EXPECT_EQ(rows_of(nearby.find(query)), nearest(places, query)) << own << " of " << most;
          }
  }
}

/// At one place nobody is nearer than others: each has some, never itself, and not all the same ones.
TEST(Nearby, ACrowdAtOnePlace) {
  Places places;
  for (std::uint32_t row = 0; row < 5000; ++row) places.push_back({{1.0, 2.0}, row});
  Nearby nearby(places.size());
  nearby.build(places);
  std::set<std::uint32_t> found;
  for (std::uint32_t own = 0; own < 5000; own += 100) {
    const Rows rows = rows_of(nearby.find({places[own].p, own, 5.0, 8}));
    EXPECT_EQ(std::set(rows.begin(), rows.end()).size(), 8u);
    EXPECT_EQ(std::count(rows.begin(), rows.end(), own), 0);
    found.insert(rows.begin(), rows.end());
  }
  EXPECT_GT(found.size(), 100u);
  EXPECT_LE(nearby.looks(), 50u * 40u);
}

/// The worst that a crowd can do: all about as far away as each other.
TEST(Nearby, ACrowdOnACircleCostsNoMoreThanItsBound) {
  Places places;
  for (std::uint32_t row = 0; row < 5000; ++row) places.push_back({{std::cos(row), std::sin(row)}, row});
  Nearby nearby(places.size());
  nearby.build(places);
  EXPECT_EQ(nearby.find({glm::dvec2{}, 9999, 5.0, 8}).size(), 8u);
  EXPECT_LE(nearby.looks(), Nearby::kMostLooks);
}

TEST(Nearby, OldPlacesCostNoMoreThanTheBound) {
  Places places;
  for (std::uint32_t row = 0; row < 2000; ++row) places.push_back({{0.0, 0.0}, row, 1});
  Nearby nearby(places.size());
  nearby.build(places);
  EXPECT_TRUE(nearby.find({.own = 0, .range = 1.0, .most = 1}).empty());
  EXPECT_EQ(nearby.looks(), Nearby::kMostLooks);
}

TEST(Nearby, AnyWhereThereIsNoPlace) {
  const Places places{{{0, 0}, 0}, {{1e7, 0}, 1}, {{0, -1e7}, 2}, {{5, 5}, 3, 1}};
  Nearby nearby(places.size());
  nearby.build(places);
  std::set<std::uint32_t> found;
  for (int i = 0; i < 4; ++i) {
    const Rows rows = rows_of(nearby.find({.own = 0, .range = 1.0, .most = 1}));
    ASSERT_EQ(rows.size(), 1u);
    found.insert(rows[0]);
  }
  EXPECT_EQ(found, (std::set<std::uint32_t>{1, 2})) << "neither itself nor what is old";
  nearby.build({});
  EXPECT_TRUE(nearby.find({.own = 0, .range = 1.0, .most = 1}).empty());
  EXPECT_TRUE(nearby.find({glm::dvec2{}, 0, 1.0, 1}).empty());
}

}  // namespace
}  // namespace sf::netio
