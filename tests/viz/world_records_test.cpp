// Figures of a world, compared with golden records of their drawings.

#include <gtest/gtest.h>

#include <map>

#include "tests/golden.h"
#include "tests/viz/drawing_record.h"
#include "tests/viz/rich_world.h"
#include "viz/trajectory_figure.h"
#include "viz/world_figure.h"

namespace sf::viz {
namespace {

using scenes::expect_drawing;

/// `count` parallel tracks, each with four poses and a contact; every third is broken.
std::vector<Track> tracks_of(std::size_t count) {
  std::vector<Track> tracks;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = 0.4 + 7.0 * static_cast<double>(i) / static_cast<double>(count), d = 0.02;
    Track track{.name = fmt::format("run {}", i + 1), .duration = 12.5};
    track.poses = {{x, 0.6, 0, 0}, {x + d, 1.6, 0, 0}, {x + d, 1.6001, 0, 0}, {x + 3 * d, 2.9, 0, 0}, {x, 3.2, 0, 0}};
    track.contacts = {0, 1, 1, 0, 1};
    if (i % 3 == 1) track.poses[2].x = NAN;
    tracks.push_back(track);
  }
  return tracks;
}

/// Counts the strokes of one colour by width and opacity.
std::map<std::string, int> strokes(const std::string& file, const std::string& color) {
  std::map<std::string, int> found;
  const std::string stroke = " stroke=\"#" + color + "\"";
  for (const std::string& line : golden::lines_of(golden::read(file)))
    if (const std::size_t at = line.find(stroke); at != std::string::npos) ++found[line.substr(at + stroke.size())];
  return found;
}

TEST(WorldRecord, ShowsOneOfEverything) {
  expect_drawing("world", [](const std::string& file) { draw_world(scenes::rich_world(), file); });
}

/// Boundary: the number of movers up to which views in a union have outlines.
TEST(WorldFigure, ViewsOfVeryManyMoversHaveNoOutlines) {
  for (const std::size_t count : {300u, 301u}) {
    world::World world = scenes::rich_world();
    world.movers.assign(count, world.movers[0]);
    const std::string file = scenes::own_file("outlines.svg");
    draw_world(world, file);
    const std::string outlines = " stroke-opacity=\"0.22\" stroke-width=\"0.5\"/>";
    EXPECT_EQ(strokes(file, "1313c6").count(outlines), count == 300 ? 1u : 0u);
  }
}

TEST(TrajectoryRecord, NamesAFewTracksInTheLegend) {
  std::vector<Track> tracks = tracks_of(4);
  tracks[3].color = 0xFF123456u;
  tracks[2].contacts.clear();
  expect_drawing("trajectories",
                 [&](const std::string& file) { draw_trajectories(scenes::make_world(8, 5, 0, 0), tracks, file); });
}

/// Boundary: the numbers of tracks at which lines, marks and crosses become thinner.
TEST(TrajectoryFigure, ManyTracksAreThinner) {
  struct Case {
    int count;
    std::string line, cross;
  };
  const std::vector<Case> cases{{7, "stroke-width=\"2.4\"", "2"},
                                {8, "stroke-opacity=\"0.949\" stroke-width=\"1.8\"", "1.2"},
                                {40, "stroke-opacity=\"0.949\" stroke-width=\"1.8\"", "1.2"},
                                {41, "stroke-opacity=\"0.902\" stroke-width=\"1.4\"", "1"},
                                {250, "stroke-opacity=\"0.902\" stroke-width=\"1.4\"", "1"},
                                {251, "stroke-opacity=\"0.8\" stroke-width=\"1\"", "0.7"}};
  for (const Case& each : cases) {
    std::vector<Track> tracks = tracks_of(static_cast<std::size_t>(each.count));
    for (Track& track : tracks) track.color = 0xFF123456u;
    const std::string file = scenes::own_file("weights.svg");
    draw_trajectories(scenes::rich_world(), tracks, file, "robot", {.line_styles = false});
    EXPECT_EQ(strokes(file, "123456")[" " + each.line + "/>"], each.count);
    const int in_legend = each.cross == "2" ? 1 : 0;
    EXPECT_EQ(strokes(file, "d4351c")[" stroke-width=\"" + each.cross + "\"/>"], 2 * each.count + in_legend);
  }
}

/// Boundary: 8 to 10 tracks are named at their ends, with `all` up to 150, and those on request.
TEST(TrajectoryFigure, ManyTracksHaveTheRequestedNames) {
  const auto drawn = [](std::size_t count, const TrackLabels& labels) {
    const std::string file = scenes::own_file("names.svg");
    draw_trajectories(scenes::rich_world(), tracks_of(count), file, "robot", {}, labels);
    return golden::read(file);
  };
  const auto names = [](const std::string& svg, const std::string& name) {
    return svg.find(">" + name + "</text>") != std::string::npos;
  };
  for (const std::size_t count : {7u, 8u, 10u, 11u, 150u, 151u}) {
    EXPECT_EQ(names(drawn(count, {}), "run 1"), count <= 10) << count;
    EXPECT_EQ(names(drawn(count, {.all = true, .names = {}}), "run 1"), count <= 150) << count;
    const std::string one = drawn(count, {.all = false, .names = {"run 2"}});
    EXPECT_TRUE(names(one, "run 2")) << count;
    EXPECT_EQ(names(one, "run 1"), count <= 7) << count << ": in the legend";
  }
}

}  // namespace
}  // namespace sf::viz
