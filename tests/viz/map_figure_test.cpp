// Pictures of maps: each cell is four pixels in its state's colour, with a line between cells.

#include "viz/map_figure.h"

#include <gtest/gtest.h>

#include "tests/viz/png.h"
#include "viz/color.h"

namespace sf::viz {
namespace {

constexpr std::uint32_t kDark = 0xFF474B50u, kBlue = 0xFF1748D1u;
const Page kThesis{.map_colors = MapColors::thesis};

std::string out(const std::string& name) { return scenes::own_file(name); }

/// All cells in turn unexplored, occupied, free.
maps::OccupancyGrid striped(std::uint32_t columns, std::uint32_t rows) {
  maps::OccupancyGrid grid(maps::GridGeometry{-1.0, 2.0, 0.1, columns, rows});
  for (std::int64_t row = 0; row < maps::rows(grid.geometry); ++row)
    for (std::int64_t column = 0; column < maps::columns(grid.geometry); ++column)
      grid.set({column, row}, static_cast<maps::Cell>((row + column) % 3));
  return grid;
}

TEST(MapFigure, CellsAreFourPixelsWithALineInBetween) {
  const maps::OccupancyGrid grid = striped(30, 30);
  draw_map(grid, {"Title", "", {}}, out("cells.png"), kThesis);
  const scenes::Picture picture = scenes::read_png(out("cells.png"));
  // The left side of the map: the first column with the colour of grid lines over the map's height.
  const int left = 86, top = 100, pitch = 5;  // below a title and a subtitle
  for (int row = 0; row < 120; ++row)
    for (int column = 0; column < 120; ++column) {
      const std::uint32_t expected[] = {kDark, kBlue, kWhite};
      const int x = left + pitch * column + 1, y = top + pitch * row + 1;
      ASSERT_EQ(picture.count(expected[(row + column) % 3], x, y, x + 4, y + 4), 16) << column << " " << row;
    }
  const std::uint32_t line = picture.at(left, top + 300);
  EXPECT_EQ(picture.count(line, left, top + 2, left + 1, top + 600), 598) << "unbroken";
  EXPECT_EQ(picture.count(line, left + 300, top + 2, left + 301, top + 600), 598);
}

TEST(MapFigure, RobotsAreMarkedWhereTheyAre) {
  maps::OccupancyGrid grid(maps::GridGeometry{-1.0, 2.0, 0.1, 10, 10});
  draw_map(grid, {"", "", {}}, out("bare.png"), kThesis);
  draw_map(grid, {"", "", {{"one", {0.0, 0.0, 0.0, 0.0}}, {"far", {99.0, 0.0, 0.0, 0.0}}}}, out("robot.png"), kThesis);
  const scenes::Picture bare = scenes::read_png(out("bare.png"));
  const scenes::Picture robot = scenes::read_png(out("robot.png"));
  EXPECT_EQ(robot.width, bare.width);
  int changed = 0, elsewhere = 0;
  // The map is centred in a picture of the smallest width.
  const int left = 86 + (bare.width - 86 - 40 - 201) / 2, top = 64;  // below a subtitle
  for (int y = top; y < top + 201; ++y)
    for (int x = left; x < left + 201; ++x) {
      if (bare.at(x, y) == robot.at(x, y)) continue;
      const bool near = std::abs(x - (left + 50)) <= 17 && std::abs(y - (top + 100)) <= 12;
      ++(near ? changed : elsewhere);
    }
  EXPECT_GT(changed, 150);
  EXPECT_EQ(elsewhere, 0);
  // In the colour of its name below the map; the second is only named there.
  const auto of = [&](std::size_t i, int y0, int y1) { return robot.count(row_color(i, 3), 0, y0, robot.width, y1); };
  EXPECT_GT(of(1, top, top + 201), 10);
  EXPECT_GT(of(1, top + 201, robot.height), 10);
  EXPECT_EQ(of(2, top, top + 201), 0);
  EXPECT_GT(of(2, top + 201, robot.height), 10);
}

TEST(MapFigure, LargeMapsAreDrawnSmaller) {
  draw_map(striped(500, 3), {"Large", "", {}}, out("large.png"), kThesis);
  const scenes::Picture picture = scenes::read_png(out("large.png"));
  EXPECT_LE(picture.width, 8200);
  EXPECT_GT(picture.width, 7000) << "as large as it may be";
  // A third of the cells each, minus the lines between them and the mixed pixels at their sides.
  const int cells = picture.count(kDark) + picture.count(kBlue);
  EXPECT_NEAR(picture.count(kDark), 0.5 * cells, 0.02 * cells);
  EXPECT_GT(cells, 2 * 500 * 9) << "nine pixels a cell at least";
  draw_map(striped(1, 1), {"Small", "with a name", {}}, out("small.png"), kThesis);
  const scenes::Picture small = scenes::read_png(out("small.png"));
  EXPECT_EQ(small.width, 640);
  EXPECT_GE(small.count(kDark), 16) << "its one cell, which is unexplored";
}

TEST(MapFigure, RosHasGreysWithoutLines) {
  draw_map(striped(30, 30), {"Title", "", {}}, out("greys.png"));
  const scenes::Picture picture = scenes::read_png(out("greys.png"));
  constexpr int kOfEach = 300 * 5 * 5;
  EXPECT_GE(picture.count(0xFFCDCDCDu), kOfEach) << "unknown: 205 as in map_server";
  EXPECT_GE(picture.count(0xFF000000u), kOfEach) << "occupied";
  EXPECT_GE(picture.count(0xFFFEFEFEu), kOfEach) << "free: 254";
}

}  // namespace
}  // namespace sf::viz
