// Prisms from outlines: sides, tops and bottoms, also with holes.

#include "scene/solids.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "scene/trapezoids.h"
#include "tests/scene/meshes.h"

namespace sf::scene {
namespace {

std::vector<world::Segment> outline(const std::vector<glm::dvec2>& corners, double z_min, double z_max) {
  std::vector<world::Segment> out;
  for (std::size_t i = 0; i < corners.size(); ++i)
    out.push_back({.a = corners[i], .b = corners[(i + 1) % corners.size()], .z_min = z_min, .z_max = z_max});
  return out;
}

std::vector<world::Segment> square(double low, double high, double z_min, double z_max) {
  return outline({{low, low}, {high, low}, {high, high}, {low, high}}, z_min, z_max);
}

double area(const std::vector<Trapezoid>& pieces) {
  double sum = 0.0;
  for (const Trapezoid& t : pieces)
    for (std::size_t k = 0; k < 4; ++k) sum += 0.5 * (t[k].x * t[(k + 1) % 4].y - t[k].y * t[(k + 1) % 4].x);
  return sum;
}

std::vector<RegionEdge> star(std::uint32_t corners, double phase, glm::dvec2 centre, double scale, bool reverse) {
  std::vector<RegionEdge> edges;
  const auto at = [&](std::uint32_t i) {
    const double angle = phase + 2.0 * M_PI * (i % corners) / corners, r = scale * (i % 2 ? 0.4 : 1.0);
    return centre + r * glm::dvec2{std::cos(angle), std::sin(angle)};
  };
  for (std::uint32_t i = 0; i < corners; ++i) {
    const std::uint32_t a = reverse ? corners - i : i, b = reverse ? corners - i - 1 : i + 1;
    edges.push_back({at(a), at(b)});
  }
  return edges;
}

double area(const std::vector<RegionEdge>& edges) {
  double sum = 0.0;
  for (const RegionEdge& e : edges) sum += 0.5 * (e.a.x * e.b.y - e.a.y * e.b.x);
  return sum;
}

/// The pieces of a star with a star-shaped hole have its area.
RC_GTEST_PROP(Trapezoids, CoverTheRegion, ()) {
  auto edges = star(2 * *rc::gen::inRange(2u, 20u), *rc::gen::element(0.0, 0.1, M_PI / 4), {3.0, -2.0}, 5.0, false);
  const auto hole = star(2 * *rc::gen::inRange(2u, 9u), *rc::gen::element(0.0, 0.3), {3.0, -2.0}, 0.5, true);
  if (*rc::gen::arbitrary<bool>()) edges.insert(edges.end(), hole.begin(), hole.end());
  RC_ASSERT(std::abs(area(trapezoids_of(edges)) - area(edges)) < 1e-12 * 78.0);
}

/// A square is one piece with its own corners; nothing comes of a region that winds clockwise.
TEST(Trapezoids, KeepCorners) {
  const std::vector<RegionEdge> edges{
      {{0, 0}, {0.3, 0}}, {{0.3, 0}, {0.3, 0.7}}, {{0.3, 0.7}, {0, 0.7}}, {{0, 0.7}, {0, 0}}};
  const auto pieces = trapezoids_of(edges);
  ASSERT_EQ(pieces.size(), 1u);
  EXPECT_EQ(pieces[0], (Trapezoid{glm::dvec2{0, 0}, {0.3, 0}, {0.3, 0.7}, {0, 0.7}}));
  EXPECT_TRUE(trapezoids_of(star(8, 0.0, {}, 1.0, true)).empty());
  EXPECT_TRUE(trapezoids_of({}).empty());
}

/// A block has four sides, a top and a bottom.
TEST(Solids, Block) { EXPECT_EQ(mesh_of(square(-1, 1, 0, 2)).faces.size(), 6u); }

/// On the floor it has no bottom; above it, it has.
TEST(Solids, OnTheFloor) {
  EXPECT_EQ(mesh_of(square(-1, 1, 0, 2), true).faces.size(), 5u);
  EXPECT_EQ(mesh_of(square(-1, 1, 0.5, 2), true).faces.size(), 6u);
}

/// A thin outline, and one that does not close, have sides only. Segments without a height have no surface.
TEST(Solids, OnlySolidsHaveTops) {
  auto thin = square(-1, 1, 0, 2);
  for (auto& s : thin) s.solid_left = false;
  EXPECT_EQ(mesh_of(thin).faces.size(), 4u);
  auto open = square(-1, 1, 0, 2);
  open.pop_back();
  EXPECT_EQ(mesh_of(open).faces.size(), 3u);
  EXPECT_TRUE(mesh_of(square(-1, 1, 2, 2)).faces.empty());
  auto unseen = square(-1, 1, 0, 2);
  for (auto& s : unseen) s.seen_by_laser = false;
  EXPECT_TRUE(mesh_of(unseen).faces.empty());
}

/// From above, a beam hits the top, or passes through a hole in it to the floor.
TEST(Solids, TopsHaveHoles) {
  for (const bool backward : {false, true}) {
    auto segments = square(-2, 2, 0, 1);
    auto hole = square(-1, 1, 0, 1);
    for (auto& s : hole) std::swap(s.a, s.b);
    if (backward) std::ranges::reverse(hole);
    segments.insert(segments.end(), hole.begin(), hole.end());
    const SurfaceTree tree = build_tree(mesh_of(segments));
    const Instance instance{&tree, {}, true};
    const auto down = [&](double x) {
      return cast({glm::dmat3(1.0), {x, 0.5, 5.0}}, {{0, 0, -1}}, 10.0, {{&instance, 1}, true}).ranges[0];
    };
    EXPECT_NEAR(down(1.5), 4.0, kRangeError);
    EXPECT_NEAR(down(0.5), 5.0, kRangeError);
    EXPECT_NEAR(down(2.5), 5.0, kRangeError);
  }
}

/// Outlines of one model at other heights have tops of their own.
TEST(Solids, StackedBlocks) {
  auto segments = square(-2, 2, 0, 1);
  const auto upper = square(-1, 1, 1, 3);
  segments.insert(segments.end(), upper.begin(), upper.end());
  const SurfaceTree tree = build_tree(mesh_of(segments));
  const Instance instance{&tree, {}, true};
  const SpatialScan scan = cast({glm::dmat3(1.0), {0.0, 0.2, 5.0}}, {{0, 0, -1}}, 10.0, {{&instance, 1}, false});
  EXPECT_NEAR(scan.ranges[0], 2.0, kRangeError);
}

/// Outlines in any order, as those of pictures, have a top with holes, and islands in these. Open ones have none.
TEST(Solids, OutlinesInAnyOrder) {
  auto segments = square(-3, 3, 0, 1);
  for (auto& s : square(-2, 2, 0, 1)) segments.push_back(s), std::swap(segments.back().a, segments.back().b);
  for (const auto& s : square(-1, 1, 0, 1)) segments.push_back(s);
  std::mt19937 random(1);
  std::ranges::shuffle(segments, random);
  const SurfaceTree tree = build_tree(mesh_of(segments, true));
  const Instance instance{&tree, {}, true};
  for (const auto& [x, range] : {std::pair{2.5, 4.0}, {1.5, 5.0}, {0.5, 4.0}, {3.5, 5.0}})
    EXPECT_NEAR(cast({glm::dmat3(1.0), {x, 0.3, 5.0}}, {{0, 0, -1}}, 10.0, {{&instance, 1}, true}).ranges[0], range,
                kRangeError);
  segments.pop_back();
  EXPECT_EQ(mesh_of(segments, true).faces.size(), 11u);
}

}  // namespace
}  // namespace sf::scene
