#include "world/wall_tree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "base/random.h"

namespace sf::world {
namespace {

TEST(SegmentsMeet, CaseByCase) {
  EXPECT_TRUE(segments_meet({0, 0}, {2, 2}, {0, 2}, {2, 0})) << "a plain crossing";
  EXPECT_FALSE(segments_meet({0, 0}, {1, 1}, {0, 3}, {3, 0})) << "lines cross, segments do not";
  EXPECT_TRUE(segments_meet({0, 0}, {1, 1}, {1, 1}, {2, 0})) << "a shared end";
  EXPECT_TRUE(segments_meet({0, 0}, {2, 0}, {1, 0}, {1, 5})) << "an end on the other";
  EXPECT_TRUE(segments_meet({0, 0}, {2, 0}, {1, 0}, {3, 0})) << "overlapping on one line";
  EXPECT_TRUE(segments_meet({0, 0}, {3, 0}, {1, 0}, {2, 0})) << "one within the other";
  EXPECT_FALSE(segments_meet({0, 0}, {1, 0}, {2, 0}, {3, 0})) << "apart on one line";
  EXPECT_FALSE(segments_meet({0, 0}, {1, 0}, {0, 1}, {1, 1})) << "parallel";
}

TEST(Distance, EndsAndMiddle) {
  EXPECT_EQ(world::distance({0, 1}, {-1, 0}, {1, 0}), 1.0);
  EXPECT_EQ(world::distance({4, 4}, {-1, 0}, {1, 0}), 5.0);
  EXPECT_EQ(world::distance({3, 4}, {0, 0}, {0, 0}), 5.0) << "a point";
}

TEST(FromSegment, EndsAndMiddle) {
  const auto from = [](glm::dvec2 p, glm::dvec2 a, glm::dvec2 b) {
    const glm::dvec2 d = from_segment(p, a, b);
    return std::pair(d.x, d.y);
  };
  EXPECT_EQ(from({0, 2}, {-1, 0}, {1, 0}), std::pair(0.0, 2.0)) << "square to it";
  EXPECT_EQ(from({4, 4}, {-1, 0}, {1, 0}), std::pair(3.0, 4.0)) << "from an end";
  EXPECT_EQ(from({3, 4}, {0, 0}, {0, 0}), std::pair(3.0, 4.0)) << "from a point";
}

std::vector<Segment> square(double half, bool counter_clockwise, bool solid_left = true) {
  const glm::dvec2 corners[] = {{-half, -half}, {half, -half}, {half, half}, {-half, half}};
  std::vector<Segment> edges;
  for (std::size_t i = 0; i < 4; ++i) {
    Segment edge{.a = corners[i], .b = corners[(i + 1) % 4]};
    if (!counter_clockwise) std::swap(edge.a, edge.b);
    edge.solid_left = solid_left;
    edges.push_back(edge);
  }
  return edges;
}

TEST(Windings, CaseByCase) {
  const std::vector<Segment> outer = square(2.0, true);
  EXPECT_EQ(winding_number(outer, {0, 0}), 1) << "within";
  EXPECT_EQ(winding_number(outer, {3, 0}), 0) << "to its right";
  EXPECT_EQ(winding_number(outer, {-3, 0}), 0) << "to its left, both sides ahead";
  EXPECT_EQ(winding_number(outer, {0, 3}), 0) << "above";
  EXPECT_EQ(winding_number(square(2.0, false), {0, 0}), -1) << "the other way round";
  EXPECT_EQ(winding_number(square(2.0, true, false), {0, 0}), 0) << "a line, nothing solid";

  std::vector<Segment> frame = outer;
  for (const Segment& edge : square(1.0, false)) frame.push_back(edge);
  EXPECT_EQ(winding_number(frame, {0, 0}), 0) << "in its hole";
  EXPECT_EQ(winding_number(frame, {1.5, 0}), 1) << "in the frame";
  std::vector<Segment> twice = outer;
  for (const Segment& edge : square(1.0, true)) twice.push_back(edge);
  EXPECT_EQ(winding_number(twice, {0, 0}), 2) << "where two overlap";
}

std::vector<Segment> random_walls(std::uint32_t count, glm::dvec2 around, double spread, double longest) {
  std::vector<Segment> walls;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto u = base::random_uniform({.seed = 7, .a = i}, 0);
    const auto v = base::random_uniform({.seed = 7, .a = i}, 1);
    const glm::dvec2 a = around + spread * glm::dvec2{u[0] - 0.5, u[1] - 0.5};
    const double length = longest * v[0] * v[0] * v[0];
    glm::dvec2 d = length * glm::dvec2{std::cos(6.3 * v[1]), std::sin(6.3 * v[1])};
    if (i % 5 == 0) d.y = 0.0;
    if (i % 5 == 1) d.x = 0.0;
    walls.push_back({.a = a, .b = a + d, .model = i});
  }
  return walls;
}

// Expects a visit to each wall that passes through the box, and to no wall outside it.
void expect_same_as_brute_force(const std::vector<Segment>& walls, glm::dvec2 around, double spread) {
  const WallTree tree(walls);
  for (std::uint32_t i = 0; i < 300; ++i) {
    const auto u = base::random_uniform({.seed = 9, .a = i}, 0);
    const glm::dvec2 p = around + spread * glm::dvec2{u[0] - 0.5, u[1] - 0.5};
    const double reach = 0.1 + 2.0 * base::random_uniform({.seed = 9, .a = i}, 1)[0];
    std::set<std::uint32_t> met;
    tree.any(box_around(p, reach), [&](const Segment& wall) {
      if (world::distance(p, wall.a, wall.b) <= reach) met.insert(wall.model);
      return false;
    });
    std::set<std::uint32_t> expected;
    for (const Segment& wall : walls) {
      if (world::distance(p, wall.a, wall.b) <= reach) expected.insert(wall.model);
    }
    ASSERT_EQ(met, expected) << "query " << i;
  }
}

TEST(WallTree, MatchesBruteForce) { expect_same_as_brute_force(random_walls(2000, {}, 40, 20), {}, 50); }

TEST(WallTree, MatchesBruteForceAmongMany) { expect_same_as_brute_force(random_walls(60'000, {}, 300, 5), {}, 160); }

TEST(WallTree, MatchesBruteForce100KmAway) {
  const glm::dvec2 far{1e5, -1e5};
  expect_same_as_brute_force(random_walls(2000, far, 40, 20), far, 50);
}

TEST(WallTree, FindsWallsOf100Km) { expect_same_as_brute_force(random_walls(500, {}, 40, 2e5), {}, 50); }

TEST(WallTree, StopsAtTheFirstMatch) {
  const WallTree tree(random_walls(100, {}, 1, 1));
  int asked = 0;
  EXPECT_TRUE(tree.any(box_around({}, 1), [&](const Segment&) { return ++asked == 3; }));
  EXPECT_EQ(asked, 3);
}

TEST(WallTree, EmptyAndEnormousQueries) {
  EXPECT_FALSE(WallTree({}).any(box_around({}, 1e12), [](const Segment&) { return true; }));
  const WallTree one(std::vector<Segment>{{.a = {0, 0}, .b = {1, 0}}});
  EXPECT_TRUE(one.any(box_around({}, 1e12), [](const Segment&) { return true; }));
}

}  // namespace
}  // namespace sf::world
