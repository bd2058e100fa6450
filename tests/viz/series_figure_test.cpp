#include "viz/series_figure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <set>

#include "tests/golden.h"
#include "tests/units.h"
#include "tests/viz/png.h"
#include "viz/color.h"

namespace sf::viz {
namespace {

/// A series of one value per second.
Series per_second(const std::string& name, const std::vector<double>& values) {
  Series series{name, {}, values};
  for (std::size_t i = 0; i < values.size(); ++i) series.times.push_back(static_cast<double>(i));
  return series;
}

SeriesOptions one_panel(const std::vector<Series>& series) {
  return {"Title", "subtitle", {{"", "distance [m]", series}}};
}

scenes::Picture drawn(const SeriesOptions& options, const char* name) {
  draw_series(options, scenes::own_file(name));
  return scenes::read_png(scenes::own_file(name));
}

/// Returns the number of pixels of `color` in columns [from, to), as fractions of the picture's width.
int colored(const scenes::Picture& p, std::uint32_t color, double from, double to) {
  return p.count(color, static_cast<int>(from * p.width), 0, static_cast<int>(to * p.width), p.height);
}

TEST(SeriesFigure, ALineRunsFromItsFirstToItsLastValue) {
  const scenes::Picture p = drawn(one_panel({per_second("a", {1, 2, 1, 2})}), "line.png");
  const std::uint32_t color = row_color(0, 1);
  for (double part = 0.1; part < 0.95; part += 0.05) EXPECT_GT(colored(p, color, part, part + 0.05), 20) << part;
}

TEST(SeriesFigure, MissingValuesAreGaps) {
  const scenes::Picture p = drawn(one_panel({per_second("a", {1, 1.1, kNaN, INFINITY, 1.1, 1})}), "gap.png");
  const std::uint32_t color = row_color(0, 1);
  EXPECT_GT(colored(p, color, 0.1, 0.2), 20);
  EXPECT_GT(colored(p, color, 0.85, 0.95), 20);
  // Only the grid is between the second and the fifth of six values.
  for (double part = 0.3; part < 0.75; part += 0.05) EXPECT_EQ(colored(p, color, part, part + 0.05), 0) << part;
}

/// Ten times as much is one step, as long as a number is above 0.
TEST(SeriesFigure, LogarithmicAxesHaveEqualDecades) {
  SeriesOptions options = one_panel({{"a", {1.0, 10.0, 100.0, 1000.0}, {1.0, 5.0, 0.0, 2.0}}});
  options.logarithmic = true;
  const scenes::Picture p = drawn(options, "decades.png");
  const std::uint32_t color = row_color(0, 1);
  EXPECT_GT(colored(p, color, 0.15, 0.3), 20) << "the first of three decades";
  EXPECT_EQ(colored(p, color, 0.45, 0.95), 0) << "none of the values 0 and 2 is joined to another";
  EXPECT_GT(colored(p, color, 0.95, 1.0), 0) << "the dot at the end";
}

/// The axes begin at 0 only if that does not compress the values too much.
TEST(SeriesFigure, StartsAtZeroUnlessThatCompressesTheValues) {
  const std::uint32_t color = row_color(0, 1);
  const auto first_column = [&](double from, bool zero) {
    SeriesOptions options = one_panel({{"a", {from, 2.0}, {1.0, 2.0}}});
    options.from_zero = zero;
    const scenes::Picture p = drawn(options, "zero.png");
    for (int x = 0; x < p.width; ++x)
      if (p.count(color, x, 0, x + 1, p.height * 85 / 100) > 0)  // above the legend
        return static_cast<double>(x) / p.width;
    return 1.0;
  };
  EXPECT_GT(first_column(0.9, true), first_column(0.9, false) + 0.3);
  EXPECT_EQ(first_column(1.9, true), first_column(1.9, false));
  EXPECT_EQ(first_column(-1.0, true), first_column(-1.0, false));
}

TEST(SeriesFigure, ALoneValueIsADot) {
  const scenes::Picture p = drawn(one_panel({per_second("a", {kNaN, 5, kNaN})}), "dot.png");
  EXPECT_GT(colored(p, row_color(0, 1), 0.45, 0.65), 0);
}

TEST(SeriesFigure, EverySeriesHasItsColor) {
  std::vector<Series> many;
  for (int i = 0; i < 12; ++i) many.push_back(per_second("robot" + std::to_string(i), {1.0 * i, i + 0.5}));
  const scenes::Picture p = drawn(one_panel(many), "many.png");
  for (std::size_t i = 0; i < many.size(); ++i) EXPECT_GT(colored(p, row_color(i, many.size()), 0, 1), 20) << i;
}

TEST(SeriesFigure, PanelsAreStacked) {
  const Panel panel{"robot", "|B| [G]", {per_second("element 0", {0, 1})}};
  const scenes::Picture one = drawn({"t", "s", {panel}}, "one.png");
  const scenes::Picture three = drawn({"t", "s", {panel, panel, panel}}, "three.png");
  EXPECT_EQ(one.width, 1600);
  EXPECT_EQ(three.width, 1600);
  EXPECT_GT(three.height, one.height);
  const std::uint32_t color = row_color(0, 1);
  for (int third = 0; third < 3; ++third)
    EXPECT_GT(three.count(color, 0, third * three.height / 3, three.width, (third + 1) * three.height / 3), 100);
}

/// Returns the number of pixels above the legend in the first series' blue, or half of it: lines are thin and run
/// between pixels.
int blue(const scenes::Picture& p) {
  constexpr int kLegend = 60;
  int n = 0;
  for (std::size_t i = 0; i < p.rgb.size() - 3u * p.width * kLegend; i += 3) n += p.rgb[i + 2] > p.rgb[i] + 60 ? 1 : 0;
  return n;
}

TEST(SeriesFigure, UnusualDataIsDrawn) {
  struct Case {
    Series series;
    int least, most;  ///< blue pixels
  };
  EXPECT_EQ(blue(drawn(one_panel({}), "empty.png")), 0);
  EXPECT_GT(drawn(one_panel({per_second("a", {1e300, -1e300})}), "labels.png").height, 600) << "no room but for labels";
  for (const Case& c : {Case{per_second("a", {7}), 2, 20},                  // one value: a dot
                        Case{per_second("a", {kNaN, kNaN}), 0, 0},          // no finite value
                        Case{per_second("a", {0, 0, 0}), 1000, 10000},      // constant zero
                        Case{per_second("a", {-1e-7, 1e-7}), 1000, 10000},  // tiny
                        Case{per_second("a", {1e15, -1e15}), 1000, 10000},  // huge
                        Case{Series{"a", {0, kNaN, 2}, {1, 2, 3}}, 2, 20},  // a time that is not finite: two dots
                        Case{Series{"a", {1e9, 1e9 + 1}, {1e9, 1e9 + 1}}, 1000, 10000}}) {  // far from zero
    const scenes::Picture p = drawn(one_panel({c.series}), "odd.png");
    EXPECT_GT(p.height, 600);
    EXPECT_GE(blue(p), c.least);
    EXPECT_LE(blue(p), c.most);
  }
}

std::string svg_of(const SeriesOptions& options, const Page& page = {}) {
  draw_series(options, scenes::own_file("series.svg"), page);
  return golden::read(scenes::own_file("series.svg"));
}

/// Returns the points of the path in the first series' colour.
std::vector<glm::dvec2> curve_of(const std::string& svg) {
  std::vector<glm::dvec2> points;
  const std::size_t end = svg.find("\" stroke=\"#0072b2\"");
  for (std::size_t at = svg.rfind("d=\"", end); at < end; ++at) {
    if (svg[at] != 'M' && svg[at] != 'L') continue;
    char* next = nullptr;
    const double x = std::strtod(svg.c_str() + at + 1, &next);
    points.push_back({x, std::strtod(next, nullptr)});
  }
  return points;
}

TEST(SeriesFigure, IntegersAreSteps) {
  SeriesOptions options = one_panel({per_second("a", {0, 1, 1, 3, 0})});
  options.panels[0].whole = true;
  const std::vector<glm::dvec2> steps = curve_of(svg_of(options));
  ASSERT_EQ(steps.size(), 8u) << "two more for each of three jumps, and one for a value that stays";
  for (std::size_t i = 0; i + 1 < steps.size(); ++i)
    EXPECT_TRUE(steps[i].x == steps[i + 1].x || steps[i].y == steps[i + 1].y) << i;
  EXPECT_EQ(steps[1].y, steps[0].y) << "a value lasts until the next one";
  options.panels[0].whole = false;
  EXPECT_EQ(curve_of(svg_of(options)).size(), 5u);
}

TEST(SeriesFigure, CurvesDifferInTheirDashes) {
  const SeriesOptions options = one_panel({per_second("a", {1, 2}), per_second("b", {2, 1}), per_second("c", {3, 1})});
  const auto dashes = [](const std::string& svg) {
    std::set<std::string> seen;
    for (std::size_t at = svg.find("stroke-dasharray"); at != std::string::npos;
         at = svg.find("stroke-dasharray", at + 1))
      seen.insert(svg.substr(at, svg.find("/>", at) - at));
    return seen.size();
  };
  EXPECT_EQ(dashes(svg_of(options)), 2u) << "the first is solid";
  EXPECT_EQ(dashes(svg_of(options, {.line_styles = false})), 0u);
}

TEST(SeriesFigure, LegendsOmitCurvesWithoutAValue) {
  const std::string svg = svg_of(one_panel({per_second("drawn", {1, 2}), per_second("silent", {kNaN, HUGE_VAL})}));
  EXPECT_NE(svg.find(">drawn<"), std::string::npos);
  EXPECT_EQ(svg.find(">silent<"), std::string::npos);
}

TEST(SeriesFigure, LegendsCountUnnamedCurves) {
  std::vector<Series> many;
  for (int i = 0; i < 8; ++i) many.push_back(per_second("curve " + std::to_string(i), {1.0 * i, i + 0.5}));
  const std::string eight = svg_of(one_panel(many));
  for (const Series& series : many) EXPECT_NE(eight.find(">" + series.name + "<"), std::string::npos) << series.name;
  for (int i = 8; i < 16; ++i) many.push_back(per_second("curve " + std::to_string(i), {1.0 * i, i + 0.5}));
  many.push_back(per_second("silent", {kNaN}));
  const std::string more = svg_of(one_panel(many));
  EXPECT_NE(more.find(">and 9 more<"), std::string::npos) << "of 16 that are drawn";
}

/// Cells narrower than a pixel of the file but higher than one keep their rows separate.
TEST(HeatMapFigure, RowsStaySharpInCoarseFiles) {
  HeatMap map{.value_name = "v", .rows = {"0", "1"}};
  for (int i = 0; i < 3000; ++i) map.times.push_back(i), map.readings.push_back({0.0, 1.0});
  map.longest_hold = 2.0;
  draw_series({"t", "s", {{"", "element", {}, false, false, map}}}, scenes::own_file("coarse.png"), {.dpi = 90.0});
  const scenes::Picture p = scenes::read_png(scenes::own_file("coarse.png"));
  int between = 0;
  const int x = p.width / 2, height = p.height * 3 / 4;
  for (int y = p.height / 4; y + 1 < height; ++y) between += p.at(x, y) != p.at(x, y + 1);
  EXPECT_LE(between, 3) << "one border, of two pixels at most";
}

/// Two elements over three readings, the last of which is late.
HeatMap small_map() {
  HeatMap map{.value_name = "range [m]", .rows = {"0 (90°)", "1 (\u221290°)"}, .times = {0.0, 1.0, 4.0}};
  map.readings = {{1.0, -HUGE_VAL}, {2.0, 5.0}, {3.0, 1.0}};
  map.limit = 5.0;
  map.too_near = "too near";
  map.no_return = "no return";
  map.longest_hold = 1.5;
  return map;
}

TEST(HeatMapFigure, MarksLimitsAndGaps) {
  SeriesOptions options{"t", "s", {{"ring", "element (bearing)", {}, false, false, small_map()}}};
  std::string svg = svg_of(options);
  for (const char* text : {"0 (90°)", "1 (\u221290°)", "range [m]", "too near", "no return", "no reading"})
    EXPECT_NE(svg.find(">" + std::string(text) + "<"), std::string::npos) << text;
  options.panels[0].map->readings = {{1.0, 1.5}, {2.0, 4.0}, {3.0, 1.0}};
  options.panels[0].map->times = {0.0, 1.0, 2.0};
  svg = svg_of(options);
  for (const char* text : {"too near", "no return", "no reading"})
    EXPECT_EQ(svg.find(">" + std::string(text) + "<"), std::string::npos) << text << " is not drawn";
}

TEST(HeatMapFigure, CellsHaveTheirColours) {
  const scenes::Picture p = drawn({"t", "s", {{"", "element", {}, false, false, small_map()}}}, "heat.png");
  const double left = 150, right = p.width - 200, top = 110, bottom = 600;
  const auto part = [&](std::uint32_t color, double x0, double x1, double y0, double y1) {
    const int a = static_cast<int>(left + x0 * (right - left)), b = static_cast<int>(left + x1 * (right - left));
    const int c = static_cast<int>(top + y0 * (bottom - top)), d = static_cast<int>(top + y1 * (bottom - top));
    return static_cast<double>(p.count(color, a, c, b, d)) / ((b - a) * (d - c));
  };
  EXPECT_GT(part(kBlack, 0.05, 0.2, 0.6, 0.9), 0.95) << "too near, in the lower row's first second";
  EXPECT_GT(part(kWhite, 0.3, 0.55, 0.6, 0.9), 0.95) << "no return, for as long as a reading lasts";
  EXPECT_LT(part(kWhite, 0.05, 0.2, 0.1, 0.4), 0.01);
  EXPECT_GT(part(kWhite, 0.75, 0.95, 0.1, 0.9), 0.5) << "hatching where the next reading is late";
  EXPECT_LT(part(kWhite, 0.75, 0.95, 0.1, 0.9), 0.98);
}

/// Larger values are lighter, so they are distinguishable in greyscale print.
TEST(HeatMapFigure, ColoursGrowLighter) {
  double last = 0.0;
  for (int i = 0; i <= 100; ++i) {
    const double lightness = to_oklab(scale_color(0.01 * i)).lightness;
    EXPECT_GE(lightness, last - 1e-3) << i;
    last = lightness;
  }
  EXPECT_EQ(scale_color(NAN), scale_color(0.0)) << "never out of the table";
}

TEST(SeriesFigure, BrokenContractsAbort) {
  EXPECT_DEATH(draw_series({"t", "s", {}}, scenes::own_file("x.png")), "0 panels");
  EXPECT_DEATH(draw_series(one_panel({Series{"a", {1, 2}, {1}}}), scenes::own_file("x.png")),
               "series a has 2 times for 1 values");
}

}  // namespace
}  // namespace sf::viz
