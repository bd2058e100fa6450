// Route networks, and the variants of the format in real files.

#include "world/roads/rndf.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/world/rndf_text.h"

namespace sf::world {
namespace {

std::string shared(const std::string& name) { return SF_SOURCE_DIR "/../shared/data/rndf/" + name; }

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

std::string replace_all(std::string text, const std::string& from, const std::string& to) {
  for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

/// Segments, lanes, zones, spots, way-points of lanes, points, exits, stops and checkpoints.
std::string counts_text(const Rndf& rndf) {
  const RoadCounts c = count(rndf);
  return fmt::format("{} {} {} {} {} {} {} {} {}", c.segments, c.lanes, c.zones, c.spots, c.lane_waypoints, c.points,
                     c.exits, c.stops, c.checkpoints);
}

TEST(Rndf, EveryStatementIsRead) {
  const Rndf rndf = small_rndf();
  EXPECT_EQ(rndf.name, "small");
  EXPECT_EQ(rndf.format_version, "1.0");
  EXPECT_EQ(rndf.creation_date, "1-Jan-07");
  EXPECT_TRUE(rndf.warnings.empty()) << lines_of(rndf.warnings);
  ASSERT_EQ(rndf.segments.size(), 2u);
  EXPECT_EQ(rndf.segments[0].name, "Main_Street");
  EXPECT_EQ(rndf.segments[1].name, "");
  const RndfLane& lane = rndf.segments[0].lanes[0];
  EXPECT_EQ(lane.number, 1);
  EXPECT_EQ(lane.width_ft, 12.0);
  EXPECT_EQ(lane.left, Boundary::double_yellow);
  EXPECT_EQ(lane.right, Boundary::solid_white);
  EXPECT_EQ(lane.checkpoints[0].id, 1);
  EXPECT_EQ(lane.checkpoints[0].at, (PointId{1, 1, 2}));
  EXPECT_EQ(lane.stops[0].at, (PointId{1, 1, 3}));
  EXPECT_EQ(lane.exits[0].from, (PointId{1, 1, 3}));
  EXPECT_EQ(lane.exits[0].to, (PointId{2, 1, 1}));
  EXPECT_EQ(lane.points[2].latitude, 40.0);
  EXPECT_EQ(lane.points[2].longitude, -82.998);
  EXPECT_EQ(lane.points[2].line, 19);
  EXPECT_FALSE(rndf.segments[1].lanes[0].width_ft.has_value());
  EXPECT_EQ(rndf.segments[1].lanes[0].left, Boundary::none);
  const RndfZone& zone = rndf.zones[0];
  EXPECT_EQ(zone.id, 3);
  EXPECT_EQ(zone.name, "Lot");
  EXPECT_EQ(zone.perimeter.size(), 4u);
  EXPECT_EQ(zone.exits[0].to, (PointId{1, 2, 1}));
  EXPECT_EQ(zone.spots[0].width_ft, 10.0);
  EXPECT_EQ(zone.spots[0].checkpoints[0].at, (PointId{3, 1, 2}));
}

TEST(Rndf, Counts) { EXPECT_EQ(counts_text(small_rndf()), "2 3 1 1 7 13 3 1 2"); }

// Each text contains one variant from real files.
TEST(Rndf, RealFileVariantsChangeNothing) {
  const std::string small(kSmallRndf);
  const std::vector<std::string> habits{
      replace_all(small, "\n", "\r\n"),
      replace_all(small, "\n", "\t\t\t\r\n"),                          // empty cells of a spreadsheet
      with(replace_all(small, "\n", "\r\n"), "small\r\n", "small\n"),  // mixed line ends
      replace_all(small, "\n", "\r"),
      replace_all(small, " ", "\t"),
      replace_all(small, "\n", "\n\n \t\n"),
      replace_all(small, "\n", " /* remark */\n"),
      replace_all(small, "\n", "\n/* remark */\n"),
      "/* over\nseveral\nlines */" + small,
      "\xEF\xBB\xBF" + small,
      small.substr(0, small.size() - 1),  // no line end in the last line
      with(small, "format_version 1.0\n", ""),
      with(small, "creation_date 1-Jan-07\n", ""),
      with(with(small, "num_segments 2\n", ""), "end_file", "num_segments 2\nend_file"),  // header at the end
      with(with(small, "lane_width 12\n", ""), "end_lane", "lane_width 12\nend_lane"),
      with(with(small, "num_perimeterpoints 4\n", ""), "3.0.1 40.0011", "num_perimeterpoints 4\n3.0.1 40.0011"),
      with(small, "1.1.1 40.000000 -83.000000", "1.1.1 +40.0000000000 -8.3e1"),  // more decimals, signs, exponents
      with(small, "lane_width 12\n", "lane_width 12.0\n"),
      with(small, "1-Jan-07", "10/25/2007 6:30:28 PM"),
      with(small, "segment_name Main_Street", "segment_name"),
      with(small, "segment_name Main_Street", "segment_name\t\t"),
      with(small, "segment_name Main_Street", "segment_name Main Street"),
      with(small, "segment_name Main_Street\n", "")};
  for (const std::string& text : habits) {
    const Rndf rndf = parse_rndf("small.rndf", text);
    const RoadCounts c = count(rndf);
    EXPECT_TRUE(rndf.warnings.empty()) << lines_of(rndf.warnings) << text;
    EXPECT_EQ(c.points, 13u) << text;
    EXPECT_EQ(c.exits, 3u) << text;
    EXPECT_EQ(rndf.segments[0].lanes[0].width_ft, 12.0) << text;
    EXPECT_EQ(rndf.segments[0].lanes[0].points[0].longitude, -83.0) << text;
    EXPECT_EQ(rndf.segments[0].lanes[0].right, Boundary::solid_white) << text;
  }
}

TEST(Rndf, EveryKindOfLineEndIsOneLine) {
  for (const std::string end : {"\n", "\r\n", "\r"})
    EXPECT_EQ(parse_rndf("x", replace_all(std::string(kSmallRndf), "\n", end)).zones[0].spots[0].points[1].line, 54);
}

TEST(Rndf, NamesMayContainBlanksOrBeEmpty) {
  EXPECT_EQ(parse_rndf("x", small_with("Main_Street", "Main  Street /* the old one */ ")).segments[0].name,
            "Main  Street");
  EXPECT_EQ(parse_rndf("x", small_with("RNDF_name small", "RNDF_name")).name, "");
}

TEST(Rndf, WidthOfZeroIsUnknown) {
  EXPECT_FALSE(parse_rndf("x", small_with("lane_width 12", "lane_width 0")).segments[0].lanes[0].width_ft.has_value());
  EXPECT_FALSE(parse_rndf("x", small_with("lane_width 12", "lane_width")).segments[0].lanes[0].width_ft.has_value());
}

// Each end may be missing: one warning, same network.
TEST(Rndf, MissingEndsAreWarnings) {
  for (const std::string end :
       {"end_lane\n", "end_segment\n", "end_perimeter\n", "end_spot\n", "end_zone\n", "end_file\n"}) {
    const Rndf rndf = parse_rndf("x", small_with(end, ""));
    EXPECT_EQ(rndf.warnings.size(), 1u) << end << lines_of(rndf.warnings);
    EXPECT_NE(lines_of(rndf.warnings).find(end.substr(0, end.size() - 1)), std::string::npos) << end;
    EXPECT_EQ(count(rndf).points, 13u) << end;
  }
  std::string none(kSmallRndf);
  for (const std::string end :
       {"end_lane\n", "end_segment\n", "end_perimeter\n", "end_spot\n", "end_zone\n", "end_file\n"})
    none = replace_all(none, end, "");
  EXPECT_EQ(count(parse_rndf("x", none)).exits, 3u);
}

// Keywords of the extension for traffic lights cause one warning each. The network is unchanged.
TEST(Rndf, ExtensionIsSkipped) {
  const std::string text =
      with(with(std::string(kSmallRndf), "segment 1\n", "num_intersections 1\nsegment 1\nspeed_limit 25\n"), "end_file",
           "intersection 1\nnum_trafficlights 1\ntrafficlight 1.1\ngroup_id 3\nposition 40 -83 "
           "5\norientation 1\nend_trafficlight\ntrafficlight 1.2\nend_intersection\nend_file");
  const Rndf rndf = parse_rndf("x", with(text, "lane 1.1\n", "lane 1.1\nlane_type car_lane\nlight 1.1.3 1.1\n"));
  EXPECT_EQ(count(rndf).points, 13u);
  EXPECT_EQ(count_of(lines_of(rndf.warnings), "'trafficlight'"), 1u);
  EXPECT_EQ(rndf.warnings.size(), 12u) << lines_of(rndf.warnings);
}

TEST(Rndf, UnknownWordsAreNamedOnceWithTheNearest) {
  const Rndf rndf = parse_rndf("x", small_with("stop 1.1.3\n", "stopp 1.1.3\nstopp 1.1.2\n"));
  EXPECT_EQ(lines_of(rndf.warnings), "15: unknown keyword 'stopp' is ignored; did you mean 'stop'?\n");
}

TEST(Rndf, TextAfterTheEndIsIgnored) {
  const Rndf rndf = parse_rndf("x", std::string(kSmallRndf) + "segment 9\n");
  EXPECT_EQ(rndf.warnings.size(), 1u);
  EXPECT_EQ(rndf.segments.size(), 2u);
}

TEST(Rndf, SkippedNumbersAreAWarning) {
  const Rndf rndf = parse_rndf("x", small_with("1.2.2 40.000050 -83", "1.2.7 40.000050 -83"));
  EXPECT_EQ(rndf.warnings.size(), 1u) << lines_of(rndf.warnings);
  EXPECT_EQ(rndf.segments[0].lanes[1].points[1].id, (PointId{1, 2, 7}));
}

TEST(Rndf, OnePointMakesALane) {
  const std::string text = with(small_with("num_waypoints 2", "num_waypoints 1"), "1.2.2 40.000050 -83.000000\n", "");
  EXPECT_EQ(parse_rndf("x", text).segments[0].lanes[1].points.size(), 1u);
}

// ------------------------------------------------------------------------------------------ public files

// Counted in the files with grep: lines that start with each keyword.
TEST(RndfFiles, Counts) {
  if (!std::filesystem::exists(shared(""))) GTEST_SKIP() << "no shared data next to the sources";
  const std::pair<const char*, const char*> files[] = {
      {"darpa_sample/Sample_RNDF_Rev_1.5.rndf", "13 21 1 6 146 164 49 21 17"},
      {"darpa_sample/uce_rndf_1_final_event.rndf", "60 77 8 114 628 941 156 41 170"},
      {"utexas/swri_site_visit.rndf", "3 6 0 0 60 60 14 4 12"},
      {"utexas/swri_site_visit_with_zones.rndf", "3 6 3 1 60 92 28 4 13"},
      {"utexas/prc_large.rndf", "6 12 1 2 115 131 33 10 18"},
      {"utexas/prc_osm.rndf", "70 70 0 0 431 431 0 0 0"},
      {"terminus_negative/mcity_generated.rndf", "33 33 0 0 572 572 67 0 0"}};
  for (const auto& [name, counts] : files) EXPECT_EQ(counts_text(read_rndf(shared(name))), counts) << name;
}

// A repeated exit counts once. An id of two lanes, segments or way-points is ambiguous.
TEST(RndfFiles, InvalidFilesAreRejectedForTheirReason) {
  if (!std::filesystem::exists(shared(""))) GTEST_SKIP() << "no shared data next to the sources";
  const std::vector<std::pair<std::string, std::string>> wrong{
      {"duplicate_exit_it.rndf", ":12: exit 1.1.2 to 2.1.2 is already in line 11"},
      {"duplicate_lane_id.rndf", ":15: lane 1.1 is already in line 8"},
      {"duplicate_segments_id.rndf", ":17: segment 1 is already in line 5"},
      {"duplicate_waypoint_id.rndf", ":15: way-point 1.1.1 is already in line 11"}};
  for (const auto& [name, reason] : wrong) {
    for (const bool strict : {true, false}) {
      if (!strict && name == "duplicate_exit_it.rndf") continue;
      expect_in(name + reason, sf::refusal_of([&] { read_rndf(shared("terminus_negative/" + name), strict); }));
    }
  }
  const Rndf twice = read_rndf(shared("terminus_negative/duplicate_exit_it.rndf"));
  EXPECT_EQ(count(twice).exits, 1u);
  EXPECT_EQ(lines_of(twice.warnings), "12: exit 1.1.2 to 2.1.2 is already in line 11; it is used once\n");
}

}  // namespace
}  // namespace sf::world
