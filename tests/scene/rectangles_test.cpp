// Rectangles from the outlines of pictures.

#include "scene/rectangles.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <random>

#include "base/pose.h"
#include "world/bitmap.h"

namespace sf::scene {
namespace {

using world::Bitmap;

Bitmap noise(std::uint32_t width, std::uint32_t height, double density, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::bernoulli_distribution is_solid(density);
  Bitmap grid{width, height, {}};
  for (std::uint32_t i = 0; i < width * height; ++i) grid.solid.push_back(is_solid(random) ? 1 : 0);
  return grid;
}

/// The outline of a picture, with `pixel` [m] in a frame at `X`.
std::vector<RegionEdge> outline(const Bitmap& grid, glm::dvec2 pixel, const base::Pose& X) {
  std::vector<RegionEdge> edges;
  const auto at = [&](world::Corner c) {
    return base::transform(
        X, world::corner_position({{}, {grid.width, grid.height}}, c, pixel.x * grid.width, pixel.y * grid.height));
  };
  for (const world::BoundaryRun& run : world::trace_boundary(grid)) edges.push_back({at(run.a), at(run.b)});
  return edges;
}

/// Returns how many pieces contain the middle of a cell.
int pieces_at(const std::vector<Trapezoid>& pieces, glm::dvec2 p) {
  return static_cast<int>(std::ranges::count_if(pieces, [&](const Trapezoid& t) {
    for (std::size_t k = 0; k < 4; ++k)
      if (!(base::cross(t[(k + 1) % 4] - t[k], p - t[k]) > 0.0)) return false;
    return true;
  }));
}

/// Any picture, in any direction and place: each solid cell is in one piece, counter-clockwise, each free cell in none,
/// and there are no more pieces than edges.
RC_GTEST_PROP(Rectangles, CoverSolidCells, ()) {
  const Bitmap grid = noise(*rc::gen::inRange(1u, 14u), *rc::gen::inRange(1u, 14u),
                            *rc::gen::element(0.1, 0.5, 0.9, 1.0), *rc::gen::arbitrary<std::uint32_t>());
  const glm::dvec2 pixel{*rc::gen::element(0.05, 1.0, 30.0), 0.1};
  const double far = *rc::gen::element(0.0, 1e3, 5e6);
  const base::Pose X{far, -0.7 * far, 0.0, *rc::gen::element(0.0, M_PI / 2, 0.3, 2.0, -1e-9)};
  const auto edges = outline(grid, pixel, X);
  const auto pieces = rectangles_of(edges);
  RC_ASSERT(pieces.has_value());
  RC_ASSERT(pieces->size() <= edges.size());
  for (std::uint32_t j = 0; j < grid.height; ++j)
    for (std::uint32_t i = 0; i < grid.width; ++i) {
      const glm::dvec2 middle{(i + 0.5 - 0.5 * grid.width) * pixel.x, (j + 0.5 - 0.5 * grid.height) * pixel.y};
      RC_ASSERT(pieces_at(*pieces, base::transform(X, middle)) == grid.solid[j * grid.width + i]);
    }
}

/// Runs of solid cells merge: a frame of walls is four rectangles, whatever its size.
TEST(Rectangles, AreLarge) {
  Bitmap grid{500, 400, std::vector<std::uint8_t>(500 * 400, 1)};
  for (std::uint32_t j = 1; j < 399; ++j)
    for (std::uint32_t i = 1; i < 499; ++i) grid.solid[j * 500 + i] = 0;
  EXPECT_EQ(rectangles_of(outline(grid, {0.05, 0.05}, {1.0, 2.0, 0.0, 0.4}))->size(), 4u);
}

/// Other outlines are none of a picture, and where rounding hides the order of lines, none is guessed.
TEST(Rectangles, RefuseOtherEdges) {
  const std::vector<RegionEdge> triangle{{{0, 0}, {2, 0}}, {{2, 0}, {0, 1}}, {{0, 1}, {0, 0}}};
  EXPECT_FALSE(rectangles_of(triangle));
  EXPECT_FALSE(rectangles_of(outline(noise(40, 40, 0.5, 1), {1e-6, 1e-6}, {9e6, 9e6, 0.0, 0.3})));
  EXPECT_TRUE(rectangles_of({})->empty());
}

}  // namespace
}  // namespace sf::scene
