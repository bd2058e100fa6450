// The field figure: its default view, and the agreement of picture and numbers.

#include "viz/field_figure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "tests/viz/png.h"
#include "viz/color.h"

namespace sf::viz {
namespace {

world::World six() {
  world::World world;
  world.name = "six";
  for (int i = 0; i < 6; ++i) world.magnets.push_back({{0.071 * (i - 2.5), 0.0}, -0.05, 1.0, 0.0125, 0});
  return world;
}

/// A synthetic field: |B| rises from zero on the left to 2 Gauss on the right.
FieldSamples slope(const FieldView& view) {
  FieldSamples samples{100, 50, {}, {}};
  for (int i = 0; i < 5000; ++i) samples.map.push_back(2e-4 * (i % 100) / 99.0);
  for (int i = 0; i <= 100; ++i) {
    const glm::dvec2 p = view.line.a + 0.01 * i * (view.line.b - view.line.a);
    samples.profile.push_back({0.01 * i * glm::length(view.line.b - view.line.a), p, {0.0, 0.0, 2e-6 * i, 3e-6 * i}});
  }
  return samples;
}

/// Returns the number of colours along the upper side of the map, which has no marks.
std::size_t colours_of_the_map(const FieldView& view, const std::string& path) {
  const scenes::Picture picture = scenes::read_png(path);
  std::set<std::uint32_t> colours;
  for (int x = view.map.x_min + 2; x < view.map.x_max - 2; ++x) colours.insert(picture.at(x, view.map.y_min + 2));
  return colours.size();
}

TEST(FieldFigure, ShowsAllMagnetsAndALineAlongThem) {
  const FieldView view = field_view(six(), {.height = 0.075});
  EXPECT_LT(view.extent.x_min, -0.1775 - 0.1);
  EXPECT_GT(view.extent.y_max, 0.1);
  EXPECT_EQ(view.line.a.y, 0.0);
  EXPECT_EQ(view.line.b.y, 0.0);
  EXPECT_LT(view.line.a.x, -0.1775);
  const double scale_x = (view.map.x_max - view.map.x_min) / (view.extent.x_max - view.extent.x_min);
  const double scale_y = (view.map.y_max - view.map.y_min) / (view.extent.y_max - view.extent.y_min);
  EXPECT_NEAR(scale_x / scale_y, 1.0, 0.01) << "a metre is a metre both ways";
}

TEST(FieldFigure, AColumnOfMagnetsHasAVerticalLine) {
  world::World world = six();
  for (world::Magnet& m : world.magnets) std::swap(m.p.x, m.p.y);
  const FieldView view = field_view(world, {.height = 0.075});
  EXPECT_EQ(view.line.a.x, 0.0);
  EXPECT_LT(view.line.a.y, -0.1775);
  EXPECT_GT(view.line.b.y, 0.1775);
}

TEST(FieldFigure, TheFigureCoversTheRequestedExtentAndLine) {
  const FieldView view = field_view(six(), {0.1, Line{{0, 1}, {2, 3}}, world::Extent{-1, -5, 3, 7}});
  EXPECT_EQ(view.line.b.x, 2.0);
  EXPECT_LE(view.extent.x_min, -1.0);
  EXPECT_LE(view.extent.y_min, -5.0 + 1e-9);
  EXPECT_GE(view.extent.x_max, 3.0);
  EXPECT_GE(view.extent.y_max, 7.0 - 1e-9);
}

/// One magnet, several at one position, one on a robot: boxes of zero size.
TEST(FieldFigure, UnusualWorldsHaveAView) {
  world::World world;
  world.movers.emplace_back();
  world.movers[0].X_WM = {10, 20, 0, 1};
  world.movers[0].magnets.push_back({{0.1, 0}, 0.05, -2.0, 0.01, 0});
  for (const double height : {0.05, 0.2, 1e4, -3.0}) {
    const FieldView view = field_view(world, {.height = height});
    EXPECT_LT(view.extent.x_min, 10.1);
    EXPECT_GT(view.extent.x_max, 10.0);
    EXPECT_GT(glm::length(view.line.b - view.line.a), 0.0);
    draw_field(world, view, slope(view), scenes::own_file("odd.png"));
    EXPECT_GT(colours_of_the_map(view, scenes::own_file("odd.png")), 50u) << height << ": from nothing to all";
  }
}

TEST(FieldFigure, StrongerFieldsAreLighterEverywhere) {
  const FieldView view = field_view(six(), {.height = 0.075, .extent = world::Extent{1, 1, 3, 2}});
  draw_field(six(), view, slope(view), scenes::own_file("slope.png"));
  const scenes::Picture picture = scenes::read_png(scenes::own_file("slope.png"));
  double before = 0.0, steps_most = 0.0, steps_least = 1.0;
  const int y = view.map.y_min + 20;
  for (int i = 0; i <= 20; ++i) {
    const int x = std::min(view.map.x_min + i * (view.map.x_max - view.map.x_min) / 20, view.map.x_max - 1);
    const double lightness = to_oklab(picture.at(x, y)).lightness;
    EXPECT_GT(lightness, before) << i;
    if (i > 0)
      steps_most = std::max(steps_most, lightness - before), steps_least = std::min(steps_least, lightness - before);
    before = lightness;
  }
  EXPECT_LT(steps_most, 1.6 * steps_least) << "evenly";
}

TEST(FieldFigure, AZeroFieldCanBeDrawn) {
  const FieldView view = field_view(six(), {.height = 0.075});
  FieldSamples none = slope(view);
  std::fill(none.map.begin(), none.map.end(), 0.0);
  for (ProfilePoint& p : none.profile) p.field = {};
  draw_field(six(), view, none, scenes::own_file("none.png"));
  EXPECT_EQ(colours_of_the_map(view, scenes::own_file("none.png")), 1u);
}

/// Figure 37 of the thesis: the field of six magnets, 7.5 cm above their tops, is nearly that of one.
TEST(FieldFigure, SixMagnetsAreNearlyContinuous) {
  gpu::Device device;
  const FieldView view = field_view(six(), {.height = 0.075});
  double done = 0.0;
  const FieldSamples samples = sample_field(six(), device, view, [&](double part) { done = part; });
  EXPECT_EQ(done, 1.0);
  ASSERT_EQ(samples.map.size(), static_cast<std::size_t>(samples.columns * samples.rows));
  double least = 1.0, most = 0.0;
  for (const ProfilePoint& p : samples.profile) {
    const double tesla = std::hypot(p.field.x, p.field.y, p.field.z);
    if (std::fabs(p.p.x) < 0.0355) least = std::min(least, tesla), most = std::max(most, tesla);
    EXPECT_GE(p.field.magnitudes, tesla * (1 - 1e-12));
  }
  EXPECT_NEAR(most / 1e-4, 1.96, 0.01);
  EXPECT_GT(least, 0.995 * most) << "between the two in the middle";
  EXPECT_NEAR(*std::max_element(samples.map.begin(), samples.map.end()), most, 1e-6 * most + 1e-8);
  EXPECT_NEAR(samples.profile.back().along, glm::length(view.line.b - view.line.a), 1e-12);
}

}  // namespace
}  // namespace sf::viz
