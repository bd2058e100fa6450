// Sidecars: position, scale and finer widths.

#include "world/roads/sidecar.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/world/rndf_text.h"
#include "world/roads/roads.h"

namespace sf::world {
namespace {

RoadSidecar read(const std::string& text) {
  std::vector<Warning> warnings;
  return parse_sidecar("small.toml", text, warnings);
}

std::string refusal(const std::string& text) {
  return sf::refusal_of([&] { check_against(read(text), small_rndf()); });
}

TEST(Sidecar, EveryKeyIsRead) {
  const RoadSidecar s = read(R"(
origin = [40.0, -83]
scale = 0.142857
position = [1, 2.5]
heading_deg = 90
lane_width_m = 0.5
paint_width_m = 0.015
dash_length_m = 0.4
dash_gap_m = 1.2
stop_width_m = 0.05
spot_width_m = 0.45
[lanes."1.2"]
width_m = 0.6
left = "solid_white"
right = "none"
[points."1.2.1"]
position = [3, -4]
)");
  EXPECT_EQ(s.origin->latitude, 40.0);
  EXPECT_EQ(s.origin->longitude, -83.0);
  EXPECT_EQ(s.scale, 0.142857);
  EXPECT_EQ(s.position.y, 2.5);
  EXPECT_DOUBLE_EQ(s.heading, M_PI / 2);
  EXPECT_EQ(s.lane_width, 0.5);
  EXPECT_EQ(s.paint_width, 0.015);
  EXPECT_EQ(s.dash_length, 0.4);
  EXPECT_EQ(s.dash_gap, 1.2);
  EXPECT_EQ(s.stop_width, 0.05);
  EXPECT_EQ(s.spot_width, 0.45);
  const RoadSidecar::Lane& lane = s.lanes.at({1, 2, 0});
  EXPECT_EQ(lane.width, 0.6);
  EXPECT_EQ(lane.left, Boundary::solid_white);
  EXPECT_EQ(lane.right, Boundary::none);
  EXPECT_EQ(s.points.at({1, 2, 1}).p->y, -4.0);
  EXPECT_EQ(s.points.at({1, 2, 1}).height, 0.0);
}

TEST(Sidecar, EmptyFileIsAccepted) {
  const RoadSidecar s = read("");
  EXPECT_EQ(s.scale, 1.0);
  EXPECT_FALSE(s.origin || s.lane_width || s.spot_width);
}

TEST(Sidecar, UnknownKeysAreWarnings) {
  std::vector<Warning> warnings;
  parse_sidecar("small.toml",
                "lane_with_m = 1\n[lanes.\"1.1\"]\nwide = 2\n[points.\"1.1.1\"]\nposition = [0, 0]\nz = 1\n", warnings);
  EXPECT_EQ(
      lines_of(warnings),
      "1: unknown key 'lane_with_m' is ignored; did you mean 'lane_width_m'?\n3: unknown key 'wide' is ignored\n6: "
      "unknown key 'z' is ignored\n");
}

TEST(Sidecar, WrongFilesAreRejected) {
  const std::vector<std::pair<std::string, std::string>> corpus{
      {"scale = ", "small.toml:1: not TOML"},
      {"\n\nscale = 0", "small.toml:3: 'scale' expects a number from 1e-6"},
      {"scale = -1", "small.toml:1: 'scale' expects a number from 0"},
      {"scale = nan", "small.toml:1: 'scale' expects a number"},
      {"scale = \"1/7\"", "small.toml:1: 'scale' expects a number"},
      {"scale = true", "small.toml:1: 'scale' expects a number"},
      {"origin = [91, 0]", "small.toml:1: 'origin' expects a number from -90 to 90"},
      {"origin = [0, 181]", "small.toml:1: 'origin' expects a number from -180 to 180"},
      {"origin = 40", "small.toml:1: 'origin' expects [latitude, longitude]"},
      {"origin = [40]", "small.toml:1: 'origin' expects [latitude, longitude]"},
      {"position = [1, 2, 3]", "small.toml:1: 'position' expects [x, y]"},
      {"position = [1e8, 0]", "small.toml:1: 'position' expects a number"},
      {"heading_deg = inf", "small.toml:1: 'heading_deg' expects a number"},
      {"lane_width_m = 0", "small.toml:1: 'lane_width_m' is 0"},
      {"dash_length_m = -1", "small.toml:1: 'dash_length_m' expects"},
      {"lanes = 3", "small.toml:1: 'lanes' expects a table"},
      {"[lanes.\"1\"]", "small.toml:1: '1' is not a lane"},
      {"[lanes.\"1.9\"]", "small.toml:1: small.rndf has no lane 1.9"},
      {"[lanes.\"1.1\"]\nleft = \"dotted\"", "small.toml:2: 'left' expects one of double_yellow"},
      {"[points.\"1.1\"]", "small.toml:1: '1.1' is not a way-point"},
      {"[points.\"1.1.1\"]", "small.toml:1: expected position = [x, y]"},
      {"[points.\"1.1.9\"]\nposition = [0, 0]", "small.toml:1: small.rndf has no point 1.1.9"}};
  for (const auto& [text, error] : corpus) EXPECT_EQ(refusal(text).substr(0, error.size()), error) << text;
}

// Non-ASCII characters are accepted in comments and after a byte order mark, and rejected elsewhere.
TEST(Sidecar, CommentsMayBeInAnyLanguage) {
  std::vector<Warning> warnings;
  EXPECT_EQ(parse_sidecar("a.toml", "\xEF\xBB\xBF# Maßstab\nscale = 0.5  # ein Halb, ½\n", warnings).scale, 0.5);
  EXPECT_TRUE(warnings.empty());
  const auto refused = [&](const std::string& text) {
    return sf::refusal_of([&] { parse_sidecar("a.toml", text, warnings); });
  };
  const std::string expected = ": a non-ASCII character; allowed only in comments on their own line";
  EXPECT_EQ(refused("scale = 1\nLDƒ = 2\n"), "a.toml:2" + expected) << "where toml++ loses its way";
  EXPECT_EQ(refused("\xC2\xA0scale = 1\n"), "a.toml:1" + expected) << "a blank that is none";
  EXPECT_EQ(refused("\"a#\" = 1 # ƒ\n"), "a.toml:1" + expected) << "a quote may hide what looks like a comment";
}

// A text that is not TOML is an error in the file, even where toml++ makes assumptions.
TEST(Sidecar, MalformedTomlIsRejected) {
  std::vector<Warning> warnings;
  for (const char* text : {"=", ".", "[", "[.]", "[[", "a..b = 1", "a. = 1", "a = {,}", "a = {.}", "a = {=1}",
                           "a = [,]", "{", "\"", "a = \"", "'''", "[a]b", "a = 1 b = 2", "[lanes.]", "scale 1"})
    EXPECT_THROW(parse_sidecar("a.toml", text, warnings), base::InputError) << text;
}

// load_roads reads the file of the same name with .toml for .rndf.
TEST(Sidecar, IsInTheFolderOfItsNetwork) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "sf_sidecar_test";
  std::filesystem::create_directories(folder);
  const std::string rndf = (folder / "small.rndf").string();
  std::ofstream(rndf) << kSmallRndf;
  std::filesystem::remove(folder / "small.toml");
  std::vector<Warning> warnings;
  EXPECT_EQ(load_roads(rndf, warnings).scale, 1.0);
  std::ofstream(folder / "small.toml") << "scale = 0.5\nspeed = 3\n";
  warnings.clear();
  EXPECT_EQ(load_roads(rndf, warnings).scale, 0.5);
  EXPECT_NE(lines_of(warnings).find("2: unknown key 'speed'"), std::string::npos);
  std::filesystem::remove_all(folder);
}

/// A point may have a place, a height, or both. Boundaries: 0 and 1000 m.
TEST(Sidecar, PointsMayHaveHeights) {
  const RoadSidecar s =
      read("[points]\n\"1.1.1\" = { height_m = 1000 }\n\"1.1.2\" = { height_m = 0, position = [1, 2] }\n");
  EXPECT_EQ(s.points.at({1, 1, 1}).height, 1000.0);
  EXPECT_FALSE(s.points.at({1, 1, 1}).p);
  EXPECT_EQ(s.points.at({1, 1, 2}).p->x, 1.0);
  expect_in("'height_m' expects a number from 0 to 1000", refusal("[points.\"1.1.1\"]\nheight_m = -0.1\n"));
  expect_in("'height_m' expects a number from 0 to 1000", refusal("[points.\"1.1.1\"]\nheight_m = 1001\n"));
  expect_in("small.toml:1: point 3.0.1 is in a zone", refusal("[points.\"3.0.1\"]\nheight_m = 1\n"));
  expect_in("small.toml:1: expected position = [x, y] in metres, or height_m", refusal("[points.\"1.1.1\"]\n"));
}

/// Heights are linear along the centre line, and along exits between their ends.
TEST(Sidecar, LanesRiseLinearlyBetweenWayPoints) {
  std::vector<Warning> warnings;
  const Rndf rndf = small_rndf();
  const RoadNetwork flat = build_network(rndf, {}, warnings);
  EXPECT_TRUE(ramps_of(flat).empty());
  RoadSidecar sidecar;
  sidecar.points[flat.lanes[0].points[1].id].height = 2.0;
  const RoadNetwork roads = build_network(rndf, sidecar, warnings);
  const RoadLane& lane = roads.lanes[0];
  EXPECT_EQ(height_at(lane, 0.0), 0.0);
  EXPECT_EQ(height_at(lane, lane.points[1].s), 2.0);
  EXPECT_NEAR(height_at(lane, 0.25 * lane.points[1].s), 0.5, 1e-12);
  EXPECT_EQ(height_at(lane, -1.0), 0.0) << "before its start";
  EXPECT_EQ(height_at(lane, 1e9), lane.points.back().z) << "beyond its end";
  EXPECT_FALSE(ramps_of(roads).empty());
}

}  // namespace
}  // namespace sf::world
