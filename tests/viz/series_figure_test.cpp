#include "viz/series_figure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/error.h"
#include "tests/viz/png.h"
#include "viz/color.h"

namespace sf::viz {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

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

/// Pixels of `color` in columns [from, to) parts of the picture's width.
int colored(const scenes::Picture& p, std::uint32_t color, double from, double to) {
  return p.count(color, static_cast<int>(from * p.width), 0, static_cast<int>(to * p.width), p.height);
}

TEST(SeriesFigure, ALineRunsFromItsFirstToItsLastValue) {
  const scenes::Picture p = drawn(one_panel({per_second("a", {1, 2, 1, 2})}), "line.png");
  const std::uint32_t color = row_color(0, 1);
  for (double part = 0.1; part < 0.95; part += 0.05) EXPECT_GT(colored(p, color, part, part + 0.05), 20) << part;
}

TEST(SeriesFigure, MissingValuesAreGaps) {
  const scenes::Picture p = drawn(one_panel({per_second("a", {1, 1.1, kNan, INFINITY, 1.1, 1})}), "gap.png");
  const std::uint32_t color = row_color(0, 1);
  EXPECT_GT(colored(p, color, 0.1, 0.2), 20);
  EXPECT_GT(colored(p, color, 0.85, 0.95), 20);
  // Between the second and the fifth of six values there is only the grid.
  for (double part = 0.3; part < 0.75; part += 0.05) EXPECT_EQ(colored(p, color, part, part + 0.05), 0) << part;
}

/// The axes begin at 0 only where that does not compress the values too much.
TEST(SeriesFigure, FromZeroWhereThatDoesNotSquash) {
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
  const scenes::Picture p = drawn(one_panel({per_second("a", {kNan, 5, kNan})}), "dot.png");
  EXPECT_GT(colored(p, row_color(0, 1), 0.45, 0.65), 0);
}

TEST(SeriesFigure, EverySeriesHasItsColor) {
  std::vector<Series> many;
  for (int i = 0; i < 12; ++i) many.push_back(per_second("robot" + std::to_string(i), {1.0 * i, i + 0.5}));
  const scenes::Picture p = drawn(one_panel(many), "many.png");
  for (std::size_t i = 0; i < many.size(); ++i) EXPECT_GT(colored(p, row_color(i, many.size()), 0, 1), 20) << i;
}

TEST(SeriesFigure, PanelsStandBelowEachOther) {
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

/// Pixels in the first series' blue, or half of it: lines are thin and lie between pixels.
int blue(const scenes::Picture& p) {
  int n = 0;
  for (std::size_t i = 0; i < p.rgb.size(); i += 3) n += p.rgb[i + 2] > p.rgb[i] + 60 ? 1 : 0;
  return n;
}

TEST(SeriesFigure, OddDataIsDrawnAllTheSame) {
  struct Case {
    Series series;
    int least, most;  ///< blue pixels without the legend's
  };
  EXPECT_EQ(blue(drawn(one_panel({}), "nobody.png")), 0);
  const int legend = blue(drawn(one_panel({Series{"a", {}, {}}}), "silent.png"));
  EXPECT_GT(drawn(one_panel({per_second("a", {1e300, -1e300})}), "labels.png").height, 600) << "no room but for labels";
  for (const Case& c : {Case{per_second("a", {7}), 2, 20},                  // one value: a dot
                        Case{per_second("a", {kNan, kNan}), 0, 0},          // no finite value
                        Case{per_second("a", {0, 0, 0}), 1000, 10000},      // constant zero
                        Case{per_second("a", {-1e-7, 1e-7}), 1000, 10000},  // tiny
                        Case{per_second("a", {1e15, -1e15}), 1000, 10000},  // huge
                        Case{Series{"a", {0, kNan, 2}, {1, 2, 3}}, 2, 20},  // a time that is not finite: two dots
                        Case{Series{"a", {1e9, 1e9 + 1}, {1e9, 1e9 + 1}}, 1000, 10000}}) {  // far from zero
    const scenes::Picture p = drawn(one_panel({c.series}), "odd.png");
    EXPECT_GT(p.height, 600);
    EXPECT_GE(blue(p) - legend, c.least);
    EXPECT_LE(blue(p) - legend, c.most);
  }
}

TEST(SeriesFigure, ThePictureIsAFunctionOfTheNumbers) {
  const SeriesOptions options = one_panel({per_second("a", {1, 2, kNan, 4}), per_second("b", {2, 1, 0, 3})});
  EXPECT_EQ(drawn(options, "same1.png").rgb, drawn(options, "same2.png").rgb);
}

TEST(SeriesFigure, BrokenContractsAbort) {
  EXPECT_DEATH(draw_series({"t", "s", {}}, scenes::own_file("x.png")), "0 panels");
  EXPECT_DEATH(draw_series(one_panel({Series{"a", {1, 2}, {1}}}), scenes::own_file("x.png")),
               "series a has 2 times for 1 values");
}

TEST(SeriesFigure, APlaceThatCannotBeWrittenIsNamed) {
  EXPECT_THROW(draw_series(one_panel({per_second("a", {1})}), "/nowhere/x.png"), base::InputError);
}

}  // namespace
}  // namespace sf::viz
