#include "viz/path_figure.h"

#include <gtest/gtest.h>

#include "tests/viz/png.h"
#include "viz/color.h"
#include "viz/road_layer.h"
#include "viz/series_figure.h"

namespace sf::viz {
namespace {

/// A straight lane of 4 m along x.
world::World lane() {
  world::World world;
  world.paths.push_back({"lane", {{.X_WP = {}, .length = 4.0, .width = 0.5}}});
  world.extent = {0.0, -0.5, 4.0, 0.5};
  return world;
}

/// A track along the lane, `aside` metres to its left.
Track track(double aside) {
  Track t{.name = "t"};
  for (int i = 0; i <= 40; ++i) t.poses.push_back({0.1 * i, aside, 0.0, 0.0});
  return t;
}

scenes::Picture drawn(const std::vector<Track>& tracks) {
  draw_along_paths(lane(), tracks, "Title", "subtitle", scenes::own_file("path.png"));
  return scenes::read_png(scenes::own_file("path.png"));
}

int colored(const scenes::Picture& p, std::uint32_t color) { return p.count(color, 0, 0, p.width, p.height); }

TEST(PathFigure, EveryTrackHasItsColorOverItsWholeLength) {
  const scenes::Picture p = drawn({track(0.2), track(-0.2)});
  for (const std::size_t row : {0u, 1u}) {
    const std::uint32_t color = row_color(row, 2);
    for (double part = 0.15; part < 0.9; part += 0.05)
      EXPECT_GT(
          p.count(color, static_cast<int>(part * p.width), 0, static_cast<int>((part + 0.05) * p.width), p.height), 30)
          << row << " " << part;
  }
}

/// Left of the lane is up.
TEST(PathFigure, LeftIsAboveRight) {
  const scenes::Picture p = drawn({track(0.3), track(-0.3)});
  const auto highest = [&](std::uint32_t color) {
    for (int y = 0; y < p.height; ++y)
      if (p.count(color, p.width / 4, y, p.width / 2, y + 1) > 20) return y;
    return p.height;
  };
  EXPECT_LT(highest(row_color(0, 2)), highest(row_color(1, 2)));
}

/// Its dashes are thin, so only few pixels have the full colour.
TEST(PathFigure, TheCentreLineIsDrawnIfThereIsAPath) {
  world::World without = lane();
  without.paths.clear();
  draw_along_paths(without, {}, "Title", "subtitle", scenes::own_file("no_path.png"));
  EXPECT_GT(colored(drawn({}), 0xFF808080u),
            30 + colored(scenes::read_png(scenes::own_file("no_path.png")), 0xFF808080u));
}

/// A lane is asphalt between its markings, not two separate bands.
TEST(PathFigure, ALaneIsFilledFromEdgeToEdge) {
  world::World world = lane();
  for (const double y : {0.25, -0.25}) world.lane_markings.push_back({{{0.0, y}, {4.0, y}}, 0.02});
  draw_along_paths(world, {}, "Title", "subtitle", scenes::own_file("lane.png"));
  const int filled = colored(scenes::read_png(scenes::own_file("lane.png")), theme::kAsphaltBand);
  world.paths.clear();
  draw_along_paths(world, {}, "Title", "subtitle", scenes::own_file("bands.png"));
  const scenes::Picture bands = scenes::read_png(scenes::own_file("bands.png"));
  // The lane is half as high as the plot, and nearly as wide as the picture.
  EXPECT_GT(filled, 3 * colored(bands, theme::kAsphaltBand));
  EXPECT_GT(filled, bands.width * bands.width / 4 / 4);
}

/// A track outside of the world is inside the picture.
TEST(PathFigure, GrowsWithItsTracks) {
  const scenes::Picture p = drawn({track(3.0)});
  EXPECT_GT(colored(p, row_color(0, 1)), 1000);
}

/// The x axis of a sweep has a separate name: the pictures differ only there, below the plot.
TEST(SeriesFigureAxis, NamesTheVariedQuantity) {
  SeriesOptions options{.title = "T", .panels = {{"", "y", {{"a", {0.0, 1.0}, {1.0, 2.0}}}}}};
  draw_series(options, scenes::own_file("axis_a.png"));
  options.x_name = "delay of readings [s]";
  draw_series(options, scenes::own_file("axis_b.png"));
  const scenes::Picture a = scenes::read_png(scenes::own_file("axis_a.png")),
                        b = scenes::read_png(scenes::own_file("axis_b.png"));
  ASSERT_EQ(a.height, b.height);
  int apart = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) {
      if (a.at(x, y) == b.at(x, y)) continue;
      ++apart;
      EXPECT_GT(y, a.height / 2);
    }
  EXPECT_GT(apart, 100);
}

}  // namespace
}  // namespace sf::viz
