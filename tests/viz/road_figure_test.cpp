// Pictures of road networks: positions, colours, and texts without overlap.

#include "viz/road_figure.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "tests/viz/png.h"
#include "viz/labels.h"
#include "viz/legend.h"
#include "viz/road_view.h"
#include "world/roads/lane_markings.h"
#include "world/roads/roads.h"

namespace sf::viz {
namespace {

using scenes::Picture;

// Two straight lanes, 3 m wide and 60 m long, a stop line and a zone with a spot.
world::RoadNetwork small() {
  const char* const text = R"(RNDF_name small
num_segments 1
num_zones 1
segment 1
num_lanes 2
segment_name Main_Street
lane 1.1
num_waypoints 2
left_boundary solid_yellow
right_boundary solid_white
stop 1.1.2
exit 1.1.2 2.0.1
checkpoint 1.1.1 7
1.1.1 0 0
1.1.2 0 0
end_lane
lane 1.2
num_waypoints 2
1.2.1 0 0
1.2.2 0 0
end_lane
end_segment
zone 2
num_spots 1
perimeter 2.0
num_perimeterpoints 4
2.0.1 0 0
2.0.2 0 0
2.0.3 0 0
2.0.4 0 0
end_perimeter
spot 2.1
2.1.1 0 0
2.1.2 0 0
end_spot
end_zone
end_file
)";
  const char* const places = R"(lane_width_m = 3
spot_width_m = 3
[points]
"1.1.1" = { position = [0, 0] }
"1.1.2" = { position = [60, 0] }
"1.2.1" = { position = [60, 3] }
"1.2.2" = { position = [0, 3] }
"2.0.1" = { position = [70, -10] }
"2.0.2" = { position = [90, -10] }
"2.0.3" = { position = [90, 10] }
"2.0.4" = { position = [70, 10] }
"2.1.1" = { position = [78, 0] }
"2.1.2" = { position = [84, 0] }
)";
  std::vector<world::Warning> warnings;
  return world::build_network(world::parse_rndf("small.rndf", text),
                              world::parse_sidecar("small.toml", places, warnings), warnings);
}

std::size_t count(const Picture& picture, std::uint32_t color) {
  return static_cast<std::size_t>(picture.count(color, 0, 0, picture.width, picture.height));
}

TEST(RoadFigure, ShowsEveryObject) {
  draw_roads(small(), scenes::own_file("roads.png"));
  const Picture picture = scenes::read_png(scenes::own_file("roads.png"));
  EXPECT_GE(picture.width, 1000);
  // About 15 px/m: 2 lanes of 60 m x 3 m are 80 000 pixels, minus the markings on them.
  EXPECT_GT(count(picture, theme::kAsphalt), 20000u);
  EXPECT_GT(count(picture, theme::kZone), 20000u);
  EXPECT_GT(count(picture, theme::kSpot), 1000u);
  EXPECT_GT(count(picture, theme::kStop), 50u);
  EXPECT_GT(count(picture, theme::kCheckpoint), 20u);
  EXPECT_GT(count(picture, world::kYellowPaint), 50u);  // the rest of its edge has mixed colours
}

// In a view with 10 px/m and the lower left corner at (-2.05, -12.05), lines run along pixel centres.
TEST(RoadView, ObjectsAreAtTheirPositions) {
  Canvas canvas(1000, 300, 0xFFFFFFFFu);
  const RoadView view{canvas, {0, 0, 1000, 300}, {-2.05, -12.05}, 10.0};
  draw_network(view, small());
  const Picture drawn = scenes::picture_of(canvas);
  const auto at = [&](double x, double y) {
    const glm::dvec2 p = view.pixel({x, y});
    return drawn.at(static_cast<int>(p.x), static_cast<int>(p.y));
  };
  EXPECT_EQ(at(10, 0.8), theme::kAsphalt);
  EXPECT_EQ(at(10, 3.8), theme::kAsphalt);
  EXPECT_EQ(at(10, -1.5), world::kWhitePaint);  // the right edge of lane 1.1
  EXPECT_EQ(at(10, 1.5), world::kYellowPaint);  // its left edge, between the lanes
  EXPECT_EQ(at(10, -2.2), 0xFFFFFFFFu);         // next to the road
  EXPECT_EQ(at(60, 0.7), theme::kStop);
  EXPECT_EQ(at(0, 0), theme::kCheckpoint);
  EXPECT_EQ(at(72, 8), theme::kZone);
  EXPECT_EQ(at(79, 1.0), theme::kSpot);
  EXPECT_EQ(at(95, 8), 0xFFFFFFFFu);
}

// Arrows point in the driving direction: their tips are ahead.
TEST(RoadView, ArrowsPointInDrivingDirection) {
  Canvas canvas(1000, 300, 0xFFFFFFFFu);
  const RoadView view{canvas, {0, 0, 1000, 300}, {-2.05, -12.05}, 10.0};
  world::RoadNetwork network = small();
  for (world::RoadLane& lane : network.lanes) lane.left = lane.right = world::Boundary::none;
  draw_network(view, network);
  // White columns along the first lane's centre line: an arrow to the right is widest at its left.
  const Picture drawn = scenes::picture_of(canvas);
  const auto white = [&](double x, double y_low, double y_high) {
    int n = 0;
    for (double y = y_low; y < y_high; y += 0.1) {
      const glm::dvec2 p = view.pixel({x, y});
      n += drawn.at(static_cast<int>(p.x), static_cast<int>(p.y)) == 0xFFFFFFFFu;
    }
    return n;
  };
  const double s = 60.0 * 0.5 / 8;  // the first of eight arrows
  EXPECT_GT(white(s - 0.7, -1.3, 1.3), white(s + 0.7, -1.3, 1.3));
  EXPECT_LT(white(60 - s - 0.7, 1.7, 4.3), white(60 - s + 0.7, 1.7, 4.3));
}

TEST(RoadFigure, NamesMayContainAnyBytes) {
  world::RoadNetwork network = small();
  network.name =
      "Stra\xDF"
      "e \xFF\xFE";
  network.segments[0].name = std::string(100000, '\xE9');
  network.zones[0].name = "";
  draw_roads(network, scenes::own_file("bytes.png"));
  draw_roads(small(), scenes::own_file("plain.png"));
  const Picture bytes = scenes::read_png(scenes::own_file("bytes.png")),
                plain = scenes::read_png(scenes::own_file("plain.png"));
  EXPECT_NEAR(bytes.count(theme::kStop), plain.count(theme::kStop), 2) << "the same roads under other names";
  EXPECT_NEAR(bytes.count(theme::kSpot), plain.count(theme::kSpot), plain.count(theme::kSpot) / 4);
  EXPECT_EQ(printable("a\xDFz\n", 10), "a?z?");
  EXPECT_EQ(printable("abcdef", 3), "abc...");
}

TEST(RoadFigure, OnePointIsEnough) {
  world::RoadNetwork network = small();
  network.lanes.resize(1);
  network.zones.clear(), network.spots.clear(), network.exits.clear(), network.stops.clear(),
      network.checkpoints.clear();
  network.segments[0].lanes = 1;
  network.lanes[0].points.resize(1);
  network.lanes[0].centre = world::smooth_curve(std::vector<glm::dvec2>{{0, 0}}, {});
  network.lanes[0].left_edge.clear(), network.lanes[0].right_edge.clear();
  network.extent = {0, 0, 0, 0};
  draw_roads(network, scenes::own_file("point.png"));
  const Picture picture = scenes::read_png(scenes::own_file("point.png"));
  EXPECT_EQ(picture.count(theme::kZone) + picture.count(theme::kSpot) + picture.count(theme::kStop), 0)
      << "removed objects are not drawn";
  EXPECT_GT(picture.count(0xFFFFFFFFu), picture.width * picture.height / 10);
}

TEST(Labels, PreferFreeSpace) {
  Canvas canvas(400, 200, 0xFFFFFFFFu);
  Labels labels({0, 0, 400, 200});
  const glm::dvec2 road[] = {{200, 0}, {200, 200}};
  labels.avoid(road, 60.0);
  EXPECT_FALSE(labels.is_bare({{190, 90}, {210, 110}}));
  EXPECT_TRUE(labels.is_bare({{250, 90}, {270, 110}}));
  const glm::dvec2 mark[] = {{200, 100}};
  ASSERT_TRUE(labels.place(canvas, mark, "x", small_text(), {4.0, 90.0, 100.0, 1.0}));
  const Picture drawn = scenes::picture_of(canvas);
  for (int x = 172; x < 228; ++x)
    for (int y = 0; y < 200; ++y) ASSERT_EQ(drawn.at(x, y), 0xFFFFFFFFu) << x << " " << y;
}

TEST(Labels, StayInside) {
  Canvas canvas(60, 20, 0xFFFFFFFFu);
  Labels labels({0, 0, 60, 20});
  const glm::dvec2 mark[] = {{30, 10}};
  EXPECT_FALSE(labels.place(canvas, mark, "much too long to fit in here", small_text()));
}

// The largest public network.
TEST(RoadFigureFiles, TheFinalIsDrawn) {
  const std::string rndf = SF_SOURCE_DIR "/../shared/data/rndf/darpa_sample/uce_rndf_1_final_event.rndf";
  if (!std::filesystem::exists(rndf)) GTEST_SKIP() << "no shared data next to the sources";
  std::vector<world::Warning> warnings;
  draw_roads(world::load_roads(rndf, warnings), scenes::own_file("final.png"));
  const Picture picture = scenes::read_png(scenes::own_file("final.png"));
  EXPECT_EQ(std::max(picture.width, picture.height), 4000);
  EXPECT_GT(count(picture, theme::kAsphalt), 100000u);
  EXPECT_GT(count(picture, theme::kCheckpoint), 170u * 20u);
}

}  // namespace
}  // namespace sf::viz
