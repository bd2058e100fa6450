// Plots of numbers and maps, compared with golden records of their drawings.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "tests/viz/drawing_record.h"
#include "viz/field_figure.h"
#include "viz/legend.h"
#include "viz/map_figure.h"
#include "viz/series_figure.h"
#include "viz/svg.h"
#include "viz/tradeoff_figure.h"

namespace sf::viz {
namespace {

using scenes::expect_drawing;

/// Many short words, whose line breaks reveal the width of a heading.
std::string filler() {
  std::string text = "words";
  for (int i = 0; i < 90; ++i) text += i % 3 == 0 ? " a" : i % 3 == 1 ? " of" : " one";
  return text;
}

Series series(const std::string& name, double scale, int steps) {
  Series s{name, {}, {}};
  for (int i = 0; i <= steps; ++i) s.times.push_back(2.0 + 0.5 * i), s.values.push_back(scale * ((i * 7) % 5 + 3));
  return s;
}

SeriesOptions panels() {
  SeriesOptions options{.title = "Three panels", .subtitle = filler()};
  options.panels = {{"", "distance [m]", {series("a", 0.1, 12), series("b", 0.15, 9)}},
                    {"second", "speed [m/s]", {series("a", 2.0, 12), series("b", 3.0, 9)}, true},
                    {"third", "angle [deg]", {}}};
  for (int i = 0; i < 3; ++i) options.panels[2].series.push_back(series(fmt::format("row {}", i), 10.0 + i, 6));
  options.panels[0].series[0].values[4] = NAN;
  options.panels[0].series[1].values[1] = options.panels[0].series[1].values[3] = NAN;
  options.panels[2].series[1].times[2] = HUGE_VAL;
  return options;
}

TEST(SeriesRecord, ShowsPanelsAndTheirLegends) {
  expect_drawing("series", [](const std::string& file) { draw_series(panels(), file); });
}

TEST(TradeoffRecord, ShowsPointsAndTheirBounds) {
  TradeoffPoint exact{"exact", 2.5e5, 0.0, 0.0, 1e-9, true, {}}, table{"table", 1.5e6, 1e-5, 3e-4, 2e-3, true, {}};
  TradeoffPoint skip{"skip4", 9.0e5, 1e-6, 4e-4, HUGE_VAL, false, {0.259, 1e-3, 2e-3}};
  const std::vector<TradeoffPanel> both{
      {"laser", "rays per second", "error [m]", {exact, table, skip}},
      {"sonar", "readings per second", "error [m]", {{"one", 700.0, 0.12, 0.3, 0.85}}}};
  expect_drawing("tradeoff", [&](const std::string& file) { draw_tradeoff("Speed", filler(), both, file); });
}

world::World magnets() {
  world::World world;
  world.name = "five";
  for (int i = 0; i < 5; ++i)
    world.magnets.push_back({{0.3 * i, 0.1 * (i % 2)}, -0.05, i == 2 ? -1.0 : 1.0, 0.0125, 0});
  world.magnet_cutoff = 2.5;
  return world;
}

/// Synthetic samples: |B| grows along x and y, the profile is a parabola.
FieldSamples samples(const FieldView& view) {
  FieldSamples made{12, 6, {}, {}};
  for (int i = 0; i < 72; ++i) made.map.push_back(2e-6 * (i % 12) * (1 + i / 12));
  for (int i = 0; i <= 20; ++i) {
    const glm::dvec2 d = view.line.b - view.line.a;
    made.profile.push_back(
        {0.05 * i * glm::length(d), view.line.a + 0.05 * i * d, {0.0, 1e-6 * i, 1e-6 * i * i, 5e-6 * i}});
  }
  return made;
}

TEST(FieldRecord, ShowsMapAndProfile) {
  const FieldView view = field_view(magnets(), {.height = 0.075});
  expect_drawing("field", [&](const std::string& file) { draw_field(magnets(), view, samples(view), file); });
}

TEST(MapRecord, ShowsCellsAndRobots) {
  maps::OccupancyGrid grid({-1.0, 2.0, 0.25, 3, 2});
  for (std::int64_t i = 0; i < 60; ++i) grid.set({i % 12, i / 12}, static_cast<maps::Cell>(i % 7 < 4 ? 2 : i % 3));
  MapFigure made{"A map", filler(), {}};
  for (int i = 0; i < 3; ++i) made.places.push_back({fmt::format("robot {}", i), {-0.9 + 0.2 * i, 1.0, 0.0, 0.5 * i}});
  expect_drawing("map", [&](const std::string& file) { draw_map(grid, made, file); });
}

TEST(LegendRecord, DrawsEachMark) {
  std::vector<LegendItem> items;
  for (int mark = 0; mark <= static_cast<int>(LegendMark::hatched); ++mark)
    items.push_back({static_cast<LegendMark>(mark), 0xFF204060u + static_cast<std::uint32_t>(mark),
                     fmt::format("mark number {}", mark), 0xFF808080u});
  Canvas canvas(600, 300, theme::kWhite);
  draw_legend(canvas, {20.0, 10.0}, items, place_legend(items, 500.0));
  expect_drawing("legend", [&](const std::string& file) { std::ofstream(file) << to_svg(canvas.drawing()); });
}

}  // namespace
}  // namespace sf::viz
