#include "viz/axes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/golden.h"
#include "tests/refusal.h"
#include "tests/viz/png.h"
#include "viz/ticks.h"

namespace sf::viz {
namespace {

TEST(Ticks, RoundDown) {
  EXPECT_DOUBLE_EQ(round_down(1.0), 1.0);
  EXPECT_DOUBLE_EQ(round_down(1.99), 1.0);
  EXPECT_DOUBLE_EQ(round_down(2.0), 2.0);
  EXPECT_DOUBLE_EQ(round_down(0.5), 0.5);
  EXPECT_DOUBLE_EQ(round_down(0.049), 0.02);
  EXPECT_DOUBLE_EQ(round_down(999.0), 500.0);
  EXPECT_DOUBLE_EQ(round_down(1000.0), 1000.0);
}

/// Steps at and just beyond 1, 2 and 5, with the digits that distinguish them.
TEST(Ticks, StepsAndDigitsAtTheirLimits) {
  struct Case {
    double smallest, step;
    int decimals;
    std::size_t count;  ///< within [0, 10 smallest]
  };
  for (const Case& c : {Case{1.0, 1.0, 0, 11},
                        {1.0001, 2.0, 0, 6},
                        {2.0, 2.0, 0, 11},
                        {2.0001, 5.0, 0, 5},
                        {5.0, 5.0, 0, 11},
                        {5.0001, 10.0, 0, 6},
                        {0.1, 0.1, 1, 11},
                        {0.11, 0.2, 1, 6},
                        {0.05, 0.05, 2, 11},
                        {0.051, 0.1, 1, 6},
                        {0.002, 0.002, 3, 11},
                        {100.0, 100.0, 0, 11}}) {
    const Ticks ticks = make_ticks(0.0, 10.0 * c.smallest, c.smallest);
    EXPECT_NEAR(ticks.step, c.step, 1e-9 * c.step) << c.smallest;
    EXPECT_EQ(ticks.decimals, c.decimals) << c.smallest;
    EXPECT_EQ(ticks.at.size(), c.count) << c.smallest;
  }
  const Ticks between = make_ticks(-1.0001, 0.9999, 1.0);
  ASSERT_EQ(between.at.size(), 2u);
  EXPECT_EQ(between.at[0], -1.0);
  EXPECT_EQ(between.at[1], 0.0);
}

TEST(Ticks, TextHasNoNegativeZero) {
  EXPECT_EQ(tick_text(-0.0, 1), "0.0");
  EXPECT_EQ(tick_text(-0.04, 1), "0.0");
  EXPECT_EQ(tick_text(-0.4, 1), "\u22120.4");
  EXPECT_EQ(tick_text(100000.25, 2), "100000.25");
}

struct Shape {
  const char* reason;
  world::Extent extent;
};

class LayoutOf : public testing::TestWithParam<Shape> {};

TEST_P(LayoutOf, ShowsEverythingAtOneScale) {
  FigureOptions options;
  options.title = "a title";
  options.subtitle = "and what is below it";
  options.extent = GetParam().extent;
  for (int i = 0; i < 9; ++i) options.legend.push_back({LegendMark::line, 0xFF000000u, "an item of the legend"});
  const FigureLayout at = lay_out(options);
  EXPECT_LE(std::max(at.width, at.height), 1602);
  EXPECT_GE(std::max(at.width, at.height), 1500);
  EXPECT_LE(at.shown.x_min, options.extent.x_min);
  EXPECT_LE(at.shown.y_min, options.extent.y_min);
  EXPECT_GE(at.shown.x_max, options.extent.x_max);
  EXPECT_GE(at.shown.y_max, options.extent.y_max);
  EXPECT_NEAR((at.shown.x_max - at.shown.x_min) * at.scale, at.plot.x_max - at.plot.x_min, 1.0);
  EXPECT_NEAR((at.shown.y_max - at.shown.y_min) * at.scale, at.plot.y_max - at.plot.y_min, 1.0);
  EXPECT_LT(at.plot.x_max, at.width);
  EXPECT_LE(at.legend_top + (at.legend.back().row + 1) * kLegendRow, at.height);
}

INSTANTIATE_TEST_SUITE_P(Shapes, LayoutOf,
                         testing::Values(Shape{"wide", {0, 0, 80, 40}}, Shape{"tall", {0, 0, 10, 60}},
                                         Shape{"square", {-5, -5, 5, 5}}, Shape{"a corridor", {0, 0, 200, 2}},
                                         Shape{"a shaft", {0, 0, 1, 300}}, Shape{"a line along x", {0, 3, 10, 3}},
                                         Shape{"a point", {4, 4, 4, 4}}, Shape{"a table top", {0, 0, 0.4, 0.3}},
                                         Shape{"far away", {100000, 99990, 100024, 100006}}),
                         [](const auto& shape) {
                           std::string name = shape.param.reason;
                           std::replace(name.begin(), name.end(), ' ', '_');
                           return name;
                         });

TEST(Layout, LabelsDoNotOverlap) {  // long numbers are farther apart
  for (const double offset : {0.0, 1e5, 1e7}) {
    FigureOptions options;
    options.extent = {offset, 0, offset + 1.3, 0.7};
    const FigureLayout at = lay_out(options);
    const Ticks ticks = make_ticks(at.shown.x_min, at.shown.x_max, at.tick_spacing / at.scale);
    ASSERT_GE(ticks.at.size(), 2u);
    for (const double value : ticks.at)
      EXPECT_LT(text_size(tick_text(value, ticks.decimals), small_text()).x, ticks.step * at.scale) << value;
  }
}

TEST(Axes, PixelsAndMetresAgree) {
  FigureOptions options;
  options.extent = {0, 0, 20, 10};
  options.margin = 0.0;
  const Axes axes(options);
  const PixelBox& plot = axes.layout().plot;
  EXPECT_NEAR(axes.pixel({0, 0}).x, plot.x_min, 1e-9);
  EXPECT_NEAR(axes.pixel({0, 0}).y, plot.y_max, 1.0);
  EXPECT_NEAR(axes.pixel({20, 10}).x, plot.x_max, 1.0);
  EXPECT_NEAR(axes.pixel({20, 10}).y, plot.y_min, 1.0);
}

TEST(Axes, NothingTouchesTheBorderOfThePicture) {  // no text is cut off
  FigureOptions options;
  options.title = std::string(200, 'W');
  options.subtitle = std::string(300, 'w');
  options.extent = {99999000, -99999000, 99999020, -99998990};
  options.legend.assign(12, {LegendMark::block, 0xFF00FF00u, "something to be known", 0xFF000000u});
  Axes axes(options);
  const std::string path = scenes::own_file("axes.png");
  axes.save(path);
  const scenes::Picture p = scenes::read_png(path);
  constexpr std::uint32_t white = 0xFFFFFFFFu;
  EXPECT_EQ(p.count(white, 0, 0, p.width, 8), 8 * p.width);
  EXPECT_EQ(p.count(white, 0, p.height - 8, p.width, p.height), 8 * p.width);
  EXPECT_EQ(p.count(white, 0, 0, 8, p.height), 8 * p.height);
  EXPECT_EQ(p.count(white, p.width - 8, 0, p.width, p.height), 8 * p.height);
}

TEST(Axes, DrawsTitleAndLegend) {
  FigureOptions options;
  options.title = "TITLE";
  options.extent = {0, 0, 10, 5};
  options.legend = {{LegendMark::block, 0xFF00AA00u, "green"}};
  Axes axes(options);
  const FigureLayout at = axes.layout();
  const std::string path = scenes::own_file("legend.png");
  axes.save(path);
  const scenes::Picture p = scenes::read_png(path);
  EXPECT_GT(p.count(0xFF202020u, 0, 0, p.width, at.plot.y_min - 2), 100) << "the title's own colour";
  EXPECT_GT(p.count(0xFF00AA00u, 0, at.plot.y_max, p.width, p.height), 300) << "the legend's block";
}

/// The scale bar is a sixth of the plot, rounded down, in kilometres from 1 km on.
TEST(Axes, TheScaleBarHasItsUnit) {
  for (const auto& [metres, text] : {std::pair{5'500.0, ">500 m<"}, {8'000.0, ">1 km<"}, {16'000.0, ">2 km<"}}) {
    const std::string file = scenes::own_file("scale_bar.svg");
    Axes axes({.title = "t", .extent = {0.0, 0.0, metres, 0.5 * metres}, .margin = 0.0});
    axes.save(file);
    expect_in(text, golden::read(file));
  }
}

}  // namespace
}  // namespace sf::viz
