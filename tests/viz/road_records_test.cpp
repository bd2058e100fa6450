// Figures of road networks, compared with golden records of their drawings.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/golden.h"
#include "tests/viz/drawing_record.h"
#include "viz/road_figure.h"
#include "world/roads/roads.h"

namespace sf::viz {
namespace {

std::string drawn(const world::RoadNetwork& network) {
  const std::string file = scenes::own_file("roads.svg");
  draw_roads(network, file);
  return golden::read(file);
}

/// A road of 670 m next to a zone with eight spots of 3 m, each with a checkpoint; in the south-east, or in the
/// north-west and without a name.
world::RoadNetwork road_with_car_park(bool north_west) {
  std::string text = fmt::format(
      "RNDF_name park\nnum_segments 1\nnum_zones 1\nsegment 1\nnum_lanes 1\n{}lane 1.1\nnum_waypoints 2\n"
      "left_boundary broken_white\nright_boundary solid_white\nexit 1.1.2 2.0.1\n1.1.1 0 0\n1.1.2 0 0\nend_lane\n"
      "end_segment\nzone 2\nnum_spots 8\nzone_name Park\nperimeter 2.0\nnum_perimeterpoints 4\n2.0.1 0 0\n2.0.2 0 0\n"
      "2.0.3 0 0\n2.0.4 0 0\nend_perimeter\n",
      north_west ? "" : "segment_name Long_Road\n");
  std::string places = "lane_width_m = 3\nspot_width_m = 3\n[points]\n";
  const auto add = [&](const std::string& point, double x, double y) {
    if (north_west) x = 600.0 - x, y = 300.0 - y;
    places += fmt::format("\"{}\" = {{ position = [{}, {}] }}\n", point, x, y);
  };
  add("1.1.1", 0, 300), add("1.1.2", 600, 0);
  add("2.0.1", 590, 30), add("2.0.2", 590, 60), add("2.0.3", 550, 60), add("2.0.4", 550, 30);
  for (int i = 1; i <= 8; ++i) {
    text += fmt::format("spot 2.{0}\ncheckpoint 2.{0}.2 {1}\n2.{0}.1 0 0\n2.{0}.2 0 0\nend_spot\n", i, 70 + i);
    add(fmt::format("2.{}.1", i), 552 + 4 * i, 40), add(fmt::format("2.{}.2", i), 552 + 4 * i, 46);
  }
  text += "end_zone\nend_file\n";
  std::vector<world::Warning> warnings;
  return world::build_network(world::parse_rndf("park.rndf", text), world::parse_sidecar("park.toml", places, warnings),
                              warnings);
}

TEST(RoadRecord, ShowsLanesTextsAndSpots) {
  std::vector<world::Warning> warnings;
  const world::RoadNetwork network = world::load_roads(SF_SOURCE_DIR "/tests/world/golden/small.rndf", warnings);
  scenes::expect_drawing("roads", [&](const std::string& file) { draw_roads(network, file); });
}

/// Its eight checkpoints are 4 m apart in a figure of 600 m: only in an inset is there room for their numbers.
TEST(RoadFigure, EnlargesACrowdedCarPark) {
  for (const bool north_west : {false, true}) {
    const std::string svg = drawn(road_with_car_park(north_west));
    for (int checkpoint = 71; checkpoint <= 78; ++checkpoint) {
      const std::string text = fmt::format(">{}</text>", checkpoint);
      EXPECT_NE(svg.find(text), std::string::npos) << checkpoint;
      EXPECT_EQ(svg.find(text), svg.rfind(text)) << checkpoint << " is named once";
    }
  }
}

}  // namespace
}  // namespace sf::viz
