// Dashes, crosses and legend samples, by their pixels.

#include "viz/legend.h"
#include "tests/viz/png.h"
#include "viz/labels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <variant>
#include <vector>

namespace sf::viz {
namespace {

/// Pixels of one row, left to right: '#' where a line 2 px thick covers them fully.
std::string row_of(const Canvas& canvas, int y) {
  std::string row;
  for (int x = 0; x < canvas.width(); ++x)
    row += scenes::picture_of(canvas).at(x, y) == kBlack   ? '#'
           : scenes::picture_of(canvas).at(x, y) == kWhite ? '.'
                                                           : '+';
  return row;
}

std::string dashes(const std::vector<Line>& lines, double on, double off) {
  Canvas canvas(60, 8, kWhite);
  draw_dashes(canvas, lines, 2.0, on, off, kBlack);
  return row_of(canvas, 3);
}

std::size_t painted(const std::string& row) {
  std::size_t n = 0;
  for (const char c : row) n += c != '.';
  return n;
}

/// 8 px on, 12 px off: lines have round ends of 1 px on both sides.
TEST(Dashes, RepeatAlongALine) {
  const std::string row = dashes({{{5, 4}, {55, 4}}}, 8.0, 12.0);
  for (const int start : {5, 25, 45}) {
    EXPECT_EQ(row.substr(start, 8), "########") << row;
    EXPECT_EQ(row.substr(start + 10, 8).find_first_not_of('.'), std::string::npos) << row;
  }
}

TEST(Dashes, StopWhereTheirLineStops) {
  const std::string row = dashes({{{5, 4}, {28, 4}}}, 8.0, 12.0);  // 3 px into the second dash
  EXPECT_EQ(row.substr(25, 3), "###") << row;
  EXPECT_EQ(row.substr(30).find_first_not_of('.'), std::string::npos) << row;
  const std::string short_of_it = dashes({{{5, 4}, {22, 4}}}, 8.0, 12.0);
  EXPECT_EQ(short_of_it.substr(15).find_first_not_of('.'), std::string::npos) << "in the gap: no second dash";
}

/// A path in pieces has the dashes of the whole path; unconnected pieces start a new dash.
TEST(Dashes, ContinueAroundTheCornersOfAPath) {
  const std::string whole = dashes({{{5, 4}, {55, 4}}}, 8.0, 12.0);
  EXPECT_EQ(dashes({{{5, 4}, {11, 4}}, {{11, 4}, {27, 4}}, {{27, 4}, {55, 4}}}, 8.0, 12.0), whole);
  const std::string apart = dashes({{{5, 4}, {15, 4}}, {{30, 4}, {50, 4}}}, 8.0, 12.0);
  EXPECT_EQ(apart.substr(30, 8), "########") << apart;
  EXPECT_EQ(apart.substr(41, 8).find_first_not_of('.'), std::string::npos) << apart;
}

/// The corner is 4 px into a dash: the other 4 px are on the second leg, followed by a gap of 12 px. Legs that share
/// only one coordinate with the previous end are new lines.
TEST(Dashes, TurnCorners) {
  const auto column_of = [](const Canvas& canvas, int x) {
    std::string column;
    for (int y = 0; y < canvas.height(); ++y) column += scenes::picture_of(canvas).at(x, y) == kBlack ? '#' : '.';
    return column;
  };
  const auto second_leg = [&](glm::dvec2 begin) {
    Canvas canvas(60, 60, kWhite);
    const std::vector<Line> legs{{{5, 4}, {29, 4}}, {begin, {begin.x, begin.y + 40}}};
    draw_dashes(canvas, legs, 2.0, 8.0, 12.0, kBlack);
    return column_of(canvas, static_cast<int>(begin.x));
  };
  const std::string corner = second_leg({29, 4});
  EXPECT_EQ(corner.substr(4, 3), "###") << corner;
  EXPECT_EQ(corner.substr(10, 8).find('#'), std::string::npos) << corner;
  EXPECT_EQ(corner.substr(20, 7), "#######") << "the next dash, 16 px behind the corner: " << corner;
  const std::string below = second_leg({29, 5});  // the same x, another y
  EXPECT_EQ(below.substr(5, 7), "#######") << "a new line begins with a dash: " << below;
  const std::string right = second_leg({40, 4});  // the same y, another x
  EXPECT_EQ(right.substr(4, 7), "#######") << right;
}

TEST(Dashes, LinesWithoutLengthAreSkipped) {
  EXPECT_EQ(painted(dashes({{{5, 4}, {5, 4}}, {{NAN, 4}, {9, 4}}, {{0, 4}, {1e9, 4}}}, 8.0, 12.0)), 0u);
}

/// Its four arms are on the diagonals and `reach` long.
TEST(Cross, HasFourArms) {
  Canvas canvas(40, 40, kWhite);
  draw_cross(canvas, {20, 20}, 10.0, 3.0, kBlack);
  for (const int d : {2, 8})
    for (const auto& [x, y] : {std::pair{20 + d, 20 + d}, {20 - d, 20 - d}, {20 + d, 20 - d}, {20 - d, 20 + d}})
      EXPECT_EQ(scenes::picture_of(canvas).at(x, y), kBlack) << x << ", " << y;
  EXPECT_EQ(scenes::picture_of(canvas).at(26, 20), kWhite) << "between them";
  EXPECT_EQ(scenes::picture_of(canvas).at(34, 34), kWhite) << "beyond them";
}

/// The states of traffic lights differ in shape: the painted area around the middle distinguishes them.
TEST(Signals, ShapesDiffer) {
  struct Case {
    LegendMark mark;
    bool middle, corner, side;  ///< painted in colour at (0, 0), (8, 8) and (11, 0) for a radius of 10
  };
  for (const Case& c : std::vector<Case>{{LegendMark::outlined_dot, true, false, false},
                                         {LegendMark::square, true, true, false},
                                         {LegendMark::hollow_square, false, true, false},
                                         {LegendMark::diamond, true, false, true},
                                         {LegendMark::hollow_diamond, false, false, true},
                                         {LegendMark::crossed_dot, false, false, false}}) {
    constexpr std::uint32_t kColor = 0xFF00FF00u;
    Canvas canvas(40, 40, kWhite);
    draw_signal(canvas, {20.5, 20.5}, 10.0, c.mark, kColor);
    EXPECT_EQ(scenes::picture_of(canvas).at(20, 20) == kColor, c.middle) << static_cast<int>(c.mark);
    EXPECT_EQ(scenes::picture_of(canvas).at(28, 28) == kColor, c.corner) << static_cast<int>(c.mark);
    EXPECT_EQ(scenes::picture_of(canvas).at(31, 20) == kColor, c.side) << static_cast<int>(c.mark);
  }
}

/// Samples of 34 px, gaps of 9 px before texts and of 30 px between items.
TEST(Legend, ARowEndsWhereTheNextItemDoesNotFit) {
  const std::vector<LegendItem> items{{LegendMark::line, kBlack, "first", 0}, {LegendMark::line, kBlack, "second", 0}};
  const double first = 43.0 + text_size("first", small_text()).x, second = 43.0 + text_size("second", small_text()).x;
  const double both = first + 30.0 + second;
  std::vector<LegendPlace> places = place_legend(items, both);
  EXPECT_EQ(places[1].x, first + 30.0) << "it just fits";
  EXPECT_EQ(places[1].row, 0);
  places = place_legend(items, std::nextafter(both, 0.0));
  EXPECT_EQ(places[1].x, 0.0);
  EXPECT_EQ(places[1].row, 1);
  places = place_legend(items, 1.0);
  EXPECT_EQ(places[0].row, 0) << "no row is left empty";
  EXPECT_EQ(places[1].row, 1);
}

/// Each sample is drawn in its colour, in its row, left of its text.
TEST(Legend, SamplesAreInTheirPositions) {
  const std::vector<LegendItem> items{{LegendMark::block, 0xFFFF0000u, "a", 0},
                                      {LegendMark::line, 0xFF00FF00u, "b", 0}};
  const std::vector<LegendPlace> places{{0.0, 0}, {0.0, 1}};
  Canvas canvas(120, 100, kWhite);
  draw_legend(canvas, {10, 10}, items, places);
  const scenes::Picture picture = scenes::picture_of(canvas);
  const auto rows_of = [&](std::uint32_t color) {
    std::vector<int> rows;
    for (int y = 0; y < canvas.height(); ++y)
      for (int x = 0; x < canvas.width(); ++x)
        if (picture.at(x, y) == color && (rows.empty() || rows.back() != y)) rows.push_back(y);
    return rows;
  };
  const std::vector<int> first = rows_of(0xFFFF0000u), second = rows_of(0xFF00FF00u);
  ASSERT_FALSE(first.empty());
  ASSERT_FALSE(second.empty());
  EXPECT_GE(first.front(), 10);
  EXPECT_LT(first.back(), 10 + kLegendRow);
  EXPECT_GE(second.front(), 10 + kLegendRow);
  EXPECT_LT(second.back(), 10 + 2 * kLegendRow);
}

/// Labels stay 2 px inside the plot, off cells of 4 px that others cover.
TEST(Labels, BoxesAreFreeUpToTheirNeighbours) {
  Labels labels({100, 50, 300, 250});
  const auto bare = [&](double x0, double y0, double x1, double y1) { return labels.is_bare({{x0, y0}, {x1, y1}}); };
  EXPECT_TRUE(bare(102.1, 52.1, 297.9, 247.9)) << "the whole plot but its rim";
  EXPECT_FALSE(bare(102.0, 60, 120, 80));
  EXPECT_FALSE(bare(110, 52.0, 120, 80));
  EXPECT_FALSE(bare(110, 60, 298.0, 80));
  EXPECT_FALSE(bare(110, 60, 120, 248.0));
  labels.forbid({{140, 90}, {159, 109}});  // cells 10 to 14 in both directions
  EXPECT_TRUE(bare(120, 70, 139.9, 180));
  EXPECT_FALSE(bare(120, 70, 140, 180));
  EXPECT_TRUE(bare(160, 70, 200, 180));
  EXPECT_FALSE(bare(159.9, 70, 200, 180));
  EXPECT_TRUE(bare(120, 70, 200, 89.9));
  EXPECT_FALSE(bare(120, 70, 200, 90));
  EXPECT_TRUE(bare(120, 110, 200, 120));
  EXPECT_FALSE(bare(120, 109.9, 200, 120));
  labels.forbid({{0, 0}, {99, 300}}), labels.forbid({{NAN, 0}, {1, 1}}), labels.forbid({{301, 0}, {400, 300}});
  labels.forbid({{0, 0}, {300, 49}}), labels.forbid({{0, 251}, {300, 400}});
  EXPECT_TRUE(bare(103, 53, 139, 247)) << "what is outside covers nothing";
  EXPECT_TRUE(bare(161, 53, 297, 247));
  const glm::dvec2 line[] = {{200.0, 150.0}, {280.0, 150.0}};
  labels.avoid(line, 8.0);  // 4 px to either side
  EXPECT_FALSE(bare(240, 140, 244, 146));
  EXPECT_TRUE(bare(240, 140, 244, 145.9));
  EXPECT_FALSE(bare(240, 154, 244, 160));
  EXPECT_TRUE(bare(240, 158, 244, 160));
}

/// The nearest position on free space; if there is none, nothing is drawn.
TEST(Labels, ArePlacedOnceEach) {
  Canvas canvas(400, 300, kWhite);
  Labels labels({0, 0, 400, 300});
  const glm::dvec2 mark[] = {{200, 150}};
  const std::size_t before = canvas.drawing().shapes.size();
  std::size_t placed = 0;
  while (placed < 100 && labels.place(canvas, mark, "a label", small_text(), {.leader = 1e9})) ++placed;
  EXPECT_GT(placed, 3u);
  EXPECT_LT(placed, 100u);
  EXPECT_EQ(canvas.drawing().shapes.size(), before + placed) << "one text each, and no leader";
  const auto* first = std::get_if<Lettering>(&canvas.drawing().shapes[before]);
  ASSERT_NE(first, nullptr);
  EXPECT_LT(length(first->at - mark[0]), 90.0);
  Canvas other(400, 300, kWhite);
  Labels free({0, 0, 400, 300});
  ASSERT_TRUE(free.place(other, mark, "far", small_text(), {.nearest = 14.0, .farthest = 14.0}));
  EXPECT_EQ(other.drawing().shapes.size(), 2u) << "no leader at its limit";
  ASSERT_TRUE(free.place(other, mark, "far", small_text(), {.nearest = 14.5, .farthest = 14.5}));
  EXPECT_EQ(other.drawing().shapes.size(), 4u) << "a leader beyond it";
}

}  // namespace
}  // namespace sf::viz
