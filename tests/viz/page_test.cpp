// Figures on the pages of a paper: small, narrow and low ones, with letters of several sizes.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "tests/golden.h"
#include "tests/refusal.h"
#include "tests/viz/letters.h"
#include "tests/viz/png.h"
#include "tests/viz/rich_world.h"
#include "tests/viz/scenes.h"
#include "viz/field_figure.h"
#include "viz/interval_figure.h"
#include "viz/lights_figure.h"
#include "viz/map_figure.h"
#include "viz/occupancy_figure.h"
#include "viz/series_figure.h"
#include "viz/tradeoff_figure.h"
#include "viz/trajectory_figure.h"
#include "viz/world_figure.h"

namespace sf::viz {
namespace {

std::string drawn(const std::function<void(const std::string&)>& draw, const std::string& name) {
  const std::string file = scenes::own_file(name + ".svg");
  draw(file);
  return golden::read(file);
}

Series wave(const std::string& name, double scale) {
  Series s{name, {}, {}};
  for (int i = 0; i < 200; ++i) s.times.push_back(0.1 * i), s.values.push_back(scale * std::sin(0.1 * i));
  return s;
}

HeatMap ranges() {
  HeatMap map{.value_name = "range [m]", .too_near = "too near (< 0.1 m)", .no_return = "no return (≥ 4 m)"};
  for (int e = 0; e < 16; ++e) map.rows.push_back(fmt::format("{} ({}°)", e, 90 - 12 * e));
  for (int i = 0; i < 100; ++i) {
    map.times.push_back(0.2 * i + (i > 50 ? 3.0 : 0.0));
    std::vector<double> row;
    for (int e = 0; e < 16; ++e) row.push_back(e == 3 ? -HUGE_VAL : e == 5 ? 4.0 : 1.0 + 0.1 * e);
    map.readings.push_back(row);
  }
  map.limit = 4.0;
  map.longest_hold = 0.3;
  return map;
}

/// Long names, as users give them, over heat maps and flat panels.
SeriesOptions long_names() {
  HeatMap map = ranges();
  for (const std::string& row : map.rows)
    map.short_rows.push_back(row.substr(row.find('(') + 1, row.size() - row.find('(') - 2));
  map.short_name = "bearing";
  const std::string name = "one_robot_with_a_long_name_of_its_own";
  SeriesOptions options{.title = "Magnetic field", .subtitle = "a world: 2 sensors"};
  options.panels = {{name, "element (bearing)", {}, false, false, map},
                    {name, "difference of |B| [G]", {wave("a", 0.004)}},
                    {name, "element (bearing)", {}, false, false, map}};
  return options;
}

SeriesOptions series() {
  SeriesOptions options{.title = "Readings of several kinds",
                        .subtitle = "a world: three sensors, of which all are shown"};
  options.panels = {{"robot one", "distance to the lane edge [m]", {wave("roomba1", 1e-6), wave("roomba2", 2e-6)}},
                    {"last element minus first", "left [counts]", {wave("pioneer", 1e6)}, false, true},
                    {"robot two", "element (bearing)", {}, false, false, ranges()}};
  return options;
}

IntervalFigure intervals(std::size_t plots) {
  IntervalFigure figure{.title = "mean_abs_error",
                        .subtitle = "mean and 95 % interval (Student's t), n = 3 per point",
                        .x_name = "default.settings.kp",
                        .y_name = "mean |control error| [controller's unit]"};
  for (std::size_t k = 0; k < plots; ++k) {
    IntervalPlot plot{fmt::format("loss = {}", k), {}, {}};
    for (int row = 0; row < 3; ++row) {
      IntervalLine line{fmt::format("delay = {}", row), {}};
      for (const double x : {0.35, 0.5, 1.0, 1.7}) line.points.push_back({x, x + row, x + row - 0.2, x + row + 0.2});
      plot.lines.push_back(line);
    }
    figure.plots.push_back(plot);
  }
  return figure;
}

/// Values of x that need an exponent.
IntervalFigure small_steps(bool logarithmic) {
  IntervalFigure figure = intervals(1);
  figure.x_name = "link.delay [s]";
  figure.logarithmic = logarithmic;
  for (IntervalLine& line : figure.plots[0].lines)
    for (std::size_t i = 0; i < line.points.size(); ++i) line.points[i].x = std::vector{1e-6, 2e-6, 5e-6, 1e-5}[i];
  return figure;
}

IntervalFigure categories() {
  IntervalFigure figure = intervals(1);
  figure.categories = {"lane-keeping with a long name", "wander", "ideal", "{ delay = 0.5, loss = 0.1 }"};
  for (IntervalLine& line : figure.plots[0].lines)
    for (std::size_t i = 0; i < line.points.size(); ++i) line.points[i].x = static_cast<double>(i);
  return figure;
}

maps::OccupancyGrid grid() {
  maps::OccupancyGrid made({-1.0, 2.0, 0.25, 3, 2});
  for (std::int64_t i = 0; i < 60; ++i) made.set({i % 12, i / 12}, static_cast<maps::Cell>(i % 3));
  return made;
}

std::vector<Track> tracks(std::size_t count) {
  std::vector<Track> all;
  for (std::size_t i = 0; i < count; ++i) {
    Track track{fmt::format("roomba{}", i), std::nullopt, {}, {}, 10.0};
    for (int k = 0; k < 20; ++k) {
      track.poses.push_back({0.3 * static_cast<double>(i) + 0.5, 0.2 * k, 0.0, 0.0});
      track.contacts.push_back(0);
    }
    all.push_back(track);
  }
  return all;
}

struct Figure {
  const char* name;
  std::function<void(const std::string&, const Page&)> draw;
};

const std::vector<Figure>& figures() {
  static const std::vector<Figure> all{
      {"series", [](const auto& file, const Page& page) { draw_series(series(), file, page); }},
      {"intervals", [](const auto& file, const Page& page) { draw_intervals(intervals(1), file, page); }},
      {"multiples", [](const auto& file, const Page& page) { draw_intervals(intervals(5), file, page); }},
      {"categories", [](const auto& file, const Page& page) { draw_intervals(categories(), file, page); }},
      {"small steps", [](const auto& file, const Page& page) { draw_intervals(small_steps(true), file, page); }},
      {"long names", [](const auto& file, const Page& page) { draw_series(long_names(), file, page); }},
      {"corridor",
       [](const auto& file, const Page& page) {
         maps::OccupancyGrid made({-1.0, 2.0, 0.25, 30, 1});
         draw_map(made, {"A map", "one", {{"robot 1", {0.0, 1.0, 0.0, 0.0}}}}, file, page);
       }},
      {"world", [](const auto& file, const Page& page) { draw_world(scenes::rich_world(), file, page); }},
      {"trajectories",
       [](const auto& file, const Page& page) {
         draw_trajectories(scenes::make_world(6, 4, 0, 0), tracks(4), file, "robot", page);
       }},
      {"occupancy", [](const auto& file, const Page& page) { draw_occupancy({}, grid(), file, page); }},
      {"map",
       [](const auto& file, const Page& page) {
         draw_map(grid(), {"A map", "one", {{"robot 1", {0.0, 1.0, 0.0, 0.0}}}}, file, page);
       }},
      {"field",
       [](const auto& file, const Page& page) {
         world::World world;
         for (int i = 0; i < 5; ++i) world.magnets.push_back({{0.3 * i, 0.0}, -0.05, 1.0, 0.0125, 0});
         const FieldView view = field_view(world, {.height = 0.075, .page = page});
         FieldSamples samples{6, 3, std::vector<double>(18, 2e-6), {}};
         for (int i = 0; i <= 20; ++i) samples.profile.push_back({0.05 * i, {}, {0.0, 1e-6 * i, 1e-6, 5e-6 * i}});
         draw_field(world, view, samples, file, page);
       }},
      {"tradeoff",
       [](const auto& file, const Page& page) {
         const TradeoffPoint point{"exact", 2.5e5, 1e-9, 1e-7, 1e-3, true, {0.5, 1e-3, 1e-2}};
         const std::vector<TradeoffPanel> panels{
             {"laser", "rays per second", "error of all [m]: median, 99 %, largest", {point}}};
         draw_tradeoff("Speed against error", "whole ticks on a device", panels, file, page);
       }},
      {"lights", [](const auto& file, const Page& page) {
         const std::vector<LightRow> rows{
             {"north", {{0.0, 5.0, world::LightState::red}, {5.0, 9.0, world::LightState::green}}}};
         draw_light_states(rows, "a town: one light", file, page);
       }}};
  return all;
}

TEST(Page, TextsAreInsideAndDoNotOverlapOnAnyPage) {
  for (const auto& [width, height, font] : {std::tuple{50.0, 0.0, 8.0},
                                            {50.0, 40.0, 6.0},
                                            {60.0, 30.0, 5.0},
                                            {88.0, 0.0, 8.0},
                                            {88.0, 60.0, 8.0},
                                            {180.0, 0.0, 10.0},
                                            {0.0, 0.0, 7.2}})
    for (const Figure& figure : figures())
      for (const bool title : {true, false}) {
        const Page page{.width = width, .height = height, .title = title, .font_size = font};
        const auto draw = [&](const std::string& file) { figure.draw(file, page); };
        scenes::expect_legible(drawn(draw, figure.name), fmt::format("{} on {} x {} mm, {} pt{}", figure.name, width,
                                                                     height, font, title ? "" : ", no title"));
      }
}

/// Every tick label has another one on its axis: in the same row, or in the same column at the left or right end.
TEST(Page, EveryAxisHasTwoTickLabels) {
  const auto is_number = [](const scenes::LetterBox& letter) {
    return letter.text.find_first_not_of("0123456789.\u2212° kM") == std::string::npos;
  };
  for (const auto& [width, height, font] :
       {std::tuple{50.0, 0.0, 7.2}, {50.0, 50.0, 7.2}, {50.0, 30.0, 8.0}, {88.0, 0.0, 8.0}, {0.0, 0.0, 7.2}})
    for (const Figure& figure : figures()) {
      const Page page{.width = width, .height = height, .font_size = font};
      const auto letters = scenes::letters_of(drawn([&](const auto& file) { figure.draw(file, page); }, figure.name));
      for (const scenes::LetterBox& a : letters) {
        if (!is_number(a)) continue;
        const auto near = [](double x, double y) { return std::abs(x - y) < 1.0; };
        const bool paired = std::any_of(letters.begin(), letters.end(), [&](const scenes::LetterBox& b) {
          return &a != &b && is_number(b) &&
                 (near(a.low.y, b.low.y) || near(a.high.x, b.high.x) || near(a.low.x, b.low.x));
        });
        EXPECT_TRUE(paired) << figure.name << " on " << width << " x " << height << " mm: '" << a.text << "'";
      }
    }
}

std::vector<std::string> texts_of(const IntervalFigure& figure, double width) {
  const Page page{.width = width};
  std::vector<std::string> texts;
  for (const auto& letter :
       scenes::letters_of(drawn([&](const auto& file) { draw_intervals(figure, file, page); }, "texts")))
    texts.push_back(letter.text);
  return texts;
}

/// Labels of swept values have the same form.
TEST(Page, SmallSweptValuesHaveOneUnit) {
  const auto has = [](const std::vector<std::string>& texts, const std::string& text) {
    return std::find(texts.begin(), texts.end(), text) != texts.end();
  };
  for (const double width : {50.0, 0.0})
    for (const bool logarithmic : {true, false}) {
      const std::vector<std::string> texts = texts_of(small_steps(logarithmic), width);
      EXPECT_TRUE(has(texts, "link.delay [10⁻⁶ s]")) << width << fmt::format(": {}", fmt::join(texts, ", "));
      EXPECT_TRUE(has(texts, "10")) << width;
      for (const std::string& text : texts) EXPECT_EQ(text.find("e\u2212"), std::string::npos) << text;
    }
  IntervalFigure powers = small_steps(true);
  for (IntervalLine& line : powers.plots[0].lines)
    for (std::size_t i = 0; i < line.points.size(); ++i)
      line.points[i].x = std::pow(10.0, -6.0 + 2.0 * static_cast<double>(i));
  std::vector<std::string> texts = texts_of(powers, 0.0);
  for (const char* text : {"10⁻⁶", "10⁻⁴", "10⁻²", "1"}) EXPECT_TRUE(has(texts, text)) << text;
  for (IntervalLine& line : powers.plots[0].lines) line.points[1].x = 3e-4;  // between powers: neither form fits all
  texts = texts_of(powers, 0.0);
  for (const char* text : {"10⁻⁶", "1", "link.delay [s]"}) EXPECT_TRUE(has(texts, text)) << text;
  for (IntervalLine& line : powers.plots[0].lines)
    for (std::size_t i = 0; i < line.points.size(); ++i) line.points[i].x = 1.0 + 1e-5 * static_cast<double>(i);
  powers.logarithmic = false;
  EXPECT_TRUE(has(texts_of(powers, 0.0), "1.000010")) << "four digits would be equal";
  IntervalFigure one = small_steps(false);
  for (IntervalLine& line : one.plots[0].lines) line.points.resize(1);
  EXPECT_TRUE(has(texts_of(one, 50.0), "1.0") || has(texts_of(one, 50.0), "0.5")) << "ticks around the only value";
}

/// Rows have short labels if long ones would take half of the picture.
TEST(Page, RowsOfNarrowHeatMapsHaveShortLabels) {
  const auto svg = [](double width) {
    return drawn([&](const auto& file) { draw_series(long_names(), file, {.width = width}); }, "rows");
  };
  EXPECT_NE(svg(50.0).find(">90°<"), std::string::npos);
  EXPECT_EQ(svg(50.0).find(">0 (90°)<"), std::string::npos);
  EXPECT_NE(svg(0.0).find(">0 (90°)<"), std::string::npos);
}

TEST(Page, UnwritableFilesAreReported) {
  for (const std::string file : {"/nowhere/x.svg", "/nowhere/x.png"})
    for (const Figure& figure : figures())
      EXPECT_EQ(refusal_of([&] { figure.draw(file, {}); }).find(file), 0u) << figure.name;
}

double millimetres(const std::string& svg, const std::string& side) {
  const std::size_t at = svg.find(" " + side + "=\"", svg.find("<svg"));
  return std::atof(svg.c_str() + at + side.size() + 3);
}

TEST(Page, FiguresHaveTheRequestedWidthAndFitAColumn) {
  for (const double width : {50.0, 88.0, 180.0})
    for (const double font : {6.0, 7.2, 8.0})
      for (const Figure& figure : figures()) {
        const Page page{.width = width, .title = false, .font_size = font};
        const std::string svg = drawn([&](const std::string& file) { figure.draw(file, page); }, figure.name);
        EXPECT_LE(millimetres(svg, "width"), width + 0.3) << figure.name;
        EXPECT_LE(millimetres(svg, "height"), kLargestColumn) << figure.name << " " << width;
      }
  const std::string svg = drawn(
      [&](const std::string& file) { draw_series(series(), file, {.width = 88.0, .title = false, .font_size = 8.0}); },
      "exact");
  EXPECT_NEAR(millimetres(svg, "width"), 88.0, 0.3) << "LaTeX needs not scale it";
}

/// 18 layout pixels are 7.2 points; with 8 points, the same letters are 8 / 7.2 times as large on paper.
TEST(Page, LettersHaveTheRequestedSize) {
  for (const double font : {5.0, 7.2, 8.0, 12.0}) {
    const Page page{.width = 100.0, .title = false, .font_size = font};
    const std::string svg = drawn([&](const std::string& file) { draw_series(series(), file, page); }, "font");
    const std::string view = svg.substr(svg.find("viewBox=\"0 0 ") + 13);
    const double pixels_per_mm = std::atof(view.c_str()) / millimetres(svg, "width");
    for (const scenes::LetterBox& letter : scenes::letters_of(svg))
      EXPECT_NEAR(letter.size / pixels_per_mm * 72.0 / 25.4, font, 0.01) << letter.text;
  }
}

}  // namespace
}  // namespace sf::viz
