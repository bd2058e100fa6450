#include "world/bitmap.h"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <tuple>

#include "base/random.h"

namespace sf::world {
namespace {

using EdgeKey = std::tuple<int, int, int, int>;

/// Rows from the top; `#` is solid.
Bitmap grid_of(const std::vector<std::string>& rows) {
  Bitmap grid{static_cast<std::uint32_t>(rows[0].size()), static_cast<std::uint32_t>(rows.size()), {}};
  for (auto row = rows.rbegin(); row != rows.rend(); ++row) {
    for (const char c : *row) grid.solid.push_back(c == '#' ? 1 : 0);
  }
  return grid;
}

bool solid(const Bitmap& grid, int i, int j) {
  const int width = static_cast<int>(grid.width), height = static_cast<int>(grid.height);
  return i >= 0 && j >= 0 && i < width && j < height && grid.solid[static_cast<std::size_t>(j * width + i)] != 0;
}

/// Finds all unit boundaries between two cells, solid on the left, cell by cell and without the code under test.
std::set<EdgeKey> unit_edges(const Bitmap& grid) {
  std::set<EdgeKey> edges;
  for (int j = 0; j < static_cast<int>(grid.height); ++j) {
    for (int i = 0; i < static_cast<int>(grid.width); ++i) {
      if (!solid(grid, i, j)) continue;
      if (!solid(grid, i, j - 1)) edges.insert({i, j, i + 1, j});
      if (!solid(grid, i + 1, j)) edges.insert({i + 1, j, i + 1, j + 1});
      if (!solid(grid, i, j + 1)) edges.insert({i + 1, j + 1, i, j + 1});
      if (!solid(grid, i - 1, j)) edges.insert({i, j + 1, i, j});
    }
  }
  return edges;
}

std::set<EdgeKey> cut(const std::vector<BoundaryRun>& runs) {
  std::set<EdgeKey> edges;
  for (const BoundaryRun& run : runs) {
    const int di = (run.b.i > run.a.i) - (run.b.i < run.a.i), dj = (run.b.j > run.a.j) - (run.b.j < run.a.j);
    int i = static_cast<int>(run.a.i), j = static_cast<int>(run.a.j);
    while (i != static_cast<int>(run.b.i) || j != static_cast<int>(run.b.j)) {
      EXPECT_TRUE(edges.insert({i, j, i + di, j + dj}).second) << "a boundary is covered twice";
      i += di;
      j += dj;
    }
  }
  return edges;
}

/// Returns the smallest number of runs: one for each unit edge that does not continue another in a straight line.
std::size_t fewest(const std::set<EdgeKey>& edges) {
  std::size_t count = 0;
  for (const auto& [ai, aj, bi, bj] : edges) count += edges.contains({2 * ai - bi, 2 * aj - bj, ai, aj}) ? 0 : 1;
  return count;
}

int winding(const std::vector<BoundaryRun>& runs, int i, int j) {
  int number = 0;  // winding number of the centre of cell (i, j): signed crossings of a ray to the right
  for (const BoundaryRun& run : runs) {
    if (run.a.i != run.b.i || static_cast<int>(run.a.i) <= i) continue;
    const int low = static_cast<int>(std::min(run.a.j, run.b.j)), high = static_cast<int>(std::max(run.a.j, run.b.j));
    if (low <= j && j < high) number += run.b.j > run.a.j ? 1 : -1;
  }
  return number;
}

void check(const Bitmap& grid) {
  const auto runs = trace_boundary(grid);
  const auto edges = unit_edges(grid);
  EXPECT_EQ(cut(runs), edges);            // each boundary once, solid on its left; so the total length is also correct
  EXPECT_EQ(runs.size(), fewest(edges));  // with the smallest number of runs
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  for (const BoundaryRun& run : runs) {
    ++balance[{run.a.i, run.a.j}];
    --balance[{run.b.i, run.b.j}];
  }
  for (const auto& [corner, sum] : balance) EXPECT_EQ(sum, 0) << "open at " << corner.first << ", " << corner.second;
  for (int j = 0; j < static_cast<int>(grid.height); ++j) {
    for (int i = 0; i < static_cast<int>(grid.width); ++i) EXPECT_EQ(winding(runs, i, j), solid(grid, i, j) ? 1 : 0);
  }
}

TEST(Bitmap, ShapesHaveTheirSides) {
  const std::pair<std::vector<std::string>, std::size_t> shapes[] = {
      {{"...", ".#.", "..."}, 4},               // one pixel
      {{"#"}, 4},                               // closed at the edge of the picture
      {{"...", "..."}, 0},                      // nothing solid
      {{"#..", "#..", "###"}, 6},               // an L
      {{"####", "#..#", "#..#", "####"}, 8},    // a ring has an inner outline, too
      {{"#.", ".#"}, 8},                        // four runs end where diagonal pixels touch
      {{".#", "#."}, 8},                        // and on the other diagonal
      {{"#.#.", ".#.#", "#.#.", ".#.#"}, 32}};  // four sides per pixel
  for (const auto& [rows, sides] : shapes) {
    EXPECT_EQ(trace_boundary(grid_of(rows)).size(), sides) << rows[0];
    check(grid_of(rows));
  }
}

TEST(Bitmap, TraceOfTooManyRunsEndsEarly) {
  // 10 x 10 single pixels: 200 horizontal runs, then 200 vertical ones, 20 per row of pixels.
  Bitmap grid{19, 19, {}};
  for (std::uint32_t i = 0; i < 19 * 19; ++i) grid.solid.push_back(i % 19 % 2 == 0 && i / 19 % 2 == 0 ? 1 : 0);
  EXPECT_EQ(trace_boundary(grid, 400).size(), 400u);
  EXPECT_EQ(trace_boundary(grid, 399).size(), 400u) << "beyond it in the last row";
  EXPECT_EQ(trace_boundary(grid, 200).size(), 220u) << "after the first row";
}

TEST(Bitmap, RandomGridsOfAllDensities) {
  for (std::uint32_t k = 0; k < 60; ++k) {
    Bitmap grid{1 + k % 13, 1 + k % 11, {}};
    for (std::uint32_t i = 0; i < grid.width * grid.height; ++i) {
      const double u = base::random_uniform({7, base::RandomStream::placement, k, 0, 0}, i)[0];
      grid.solid.push_back(u < (k % 9 + 1) / 10.0 ? 1 : 0);
    }
    check(grid);
  }
}

TEST(Bitmap, PartSpansTheSizeItself) {
  const PicturePart part{{3, 1}, {7, 2}};
  EXPECT_EQ(corner_position(part, {3, 1}, 8.0, 2.0), glm::dvec2(-4.0, -1.0));
  EXPECT_EQ(corner_position(part, {7, 2}, 8.0, 2.0), glm::dvec2(4.0, 1.0));
  EXPECT_EQ(corner_position(part, {4, 1}, 8.0, 2.0).x, -2.0);
  EXPECT_EQ(corner_position(part, {0, 0}, 8.0, 2.0), glm::dvec2(-10.0, -3.0)) << "below the part";
}

}  // namespace
}  // namespace sf::world
