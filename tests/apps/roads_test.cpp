// `check` and `draw` of road networks and missions.

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/apps/json.h"
#include "tests/apps/program.h"
#include "tests/viz/png.h"

namespace sf {

namespace {

const char* const kRoads = R"(RNDF_name two
num_segments 1
num_zones 0
segment 1
num_lanes 2
segment_name Straight
lane 1.1
num_waypoints 2
left_boundary double_yellow
checkpoint 1.1.2 5
exit 1.1.2 1.2.1
stop 1.1.2
1.1.1 40.000000 -83.000000
1.1.2 40.000000 -82.999000
end_lane
lane 1.2
num_waypoints 2
lane_width 12
1.2.1 40.000040 -82.999000
1.2.2 40.000040 -83.000000
end_lane
end_segment
end_file
)";

const char* const kMission =
    "MDF_name go\nRNDF two\ncheckpoints\nnum_checkpoints 1\n5\nend_checkpoints\nspeed_limits\n"
    "num_speed_limits 2\n1 0 15\n9 0 15\nend_speed_limits\nend_file\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

TEST(Roads, NamesWithAnyBytesGiveValidJson) {
  const Folder folder;
  const Outcome outcome = run_successfully(
      {"check",
       folder.write("two.rndf", replaced(kRoads, "RNDF_name two", "RNDF_name a\"b\\c\xFF\xC3\xA4\xED\xA0\x80")),
       "--json"});
  const std::string bad = "\xEF\xBF\xBD";
  EXPECT_EQ(Json(outcome.out).text("/network"), "a\"b\\c" + bad + "\xC3\xA4" + bad + bad + bad);
}

TEST(Roads, TextNamesWarningsWithTheirLine) {
  const Folder folder;
  const std::string file = folder.write("two.rndf", kRoads);
  const Outcome outcome = run_successfully({"check", file});
  EXPECT_NE(outcome.out.find(file + ":7: warning: lane 1.1 has no lane_width; assuming 12 ft"), std::string::npos);
  EXPECT_NE(outcome.out.find("lanes              2 (170.8 m in all)"), std::string::npos) << outcome.out;
}

TEST(Roads, SidecarIsRead) {
  const Folder folder;
  folder.write("two.toml", "scale = 0.5\nlane_width_m = 0.5\n");
  const Outcome outcome = run_successfully({"check", folder.write("two.rndf", kRoads), "--json"});
  EXPECT_EQ(Json(outcome.out).number("/scale"), 0.5);
  EXPECT_EQ(Json(outcome.out).size("/warnings"), 0u);
}

TEST(Roads, AnErrorIsOneLineWithItsPosition) {
  const Folder folder;
  const std::string file = folder.write("two.rndf", replaced(kRoads, "1.2.1\nstop", "9.9.9\nstop"));
  const Outcome outcome = run_program({"check", file});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(outcome.err.find("sensorfarm: " + file + ":11: the exit leads to way-point 9.9.9"), 0u) << outcome.err;
  EXPECT_EQ(count_lines(outcome.err), 1u);
}

TEST(Roads, AcceptsBothSuffixesInAnyCase) {
  const Folder folder;
  for (const char* name : {"two.rdf", "TWO.RNDF"})
    EXPECT_EQ(Json(run_program({"check", folder.write(name, kRoads), "--json"}).out).number("/roads/lanes"), 2) << name;
}

TEST(Roads, IsDrawn) {
  const Folder folder;
  run_successfully({"draw", folder.write("two.rndf", kRoads), "-o", folder.path("two.png")});
  scenes::expect_painted(folder.path("two.png"), {{viz::theme::kAsphalt, 1000}});
}

TEST(Missions, WithoutTheirNetwork) {
  const Folder folder;
  const Json facts = run_json({"check", folder.write("go.mdf", kMission), "--json"});
  EXPECT_EQ(facts.text("/mission"), "go");
  EXPECT_EQ(facts.text("/rndf"), "two");
  EXPECT_TRUE(facts.is_null("/checked_against"));
  EXPECT_EQ(facts.number("/checkpoints/0"), 5);
  EXPECT_EQ(facts.size("/speed_limits"), 2u);
  EXPECT_EQ(facts.size("/warnings"), 0u);
}

TEST(Missions, AgainstTheirNetwork) {
  const Folder folder;
  const std::string rndf = folder.write("two.rndf", kRoads);
  const std::string mission = folder.write("go.mdf", kMission);
  const Outcome fine = run_successfully({"check", mission, "--rndf", rndf, "--json"});
  EXPECT_EQ(Json(fine.out).text("/checked_against"), rndf);
  EXPECT_EQ(Json(fine.out).number("/warnings/0/line"), 10);  // a speed limit for 9, which does not exist

  expect_refused({"check", folder.write("no.mdf", replaced(kMission, "\n5\n", "\n6\n")), "--rndf", rndf},
                 "no.mdf:5: checkpoint 6 does not exist");
}

TEST(Missions, WrongUsageIsRejected) {
  const Folder folder;
  const std::string rndf = folder.write("two.rndf", kRoads);
  expect_refused({"check", rndf, "--rndf", rndf}, "use --rndf with `check` of an .mdf file");
  expect_refused({"draw", folder.write("go.mdf", kMission), "-o", folder.path("x.png")}, "a mission cannot be drawn");
}

TEST(Roads, PublicFilesHaveTheirCounts) {
  const std::string folder = SF_SOURCE_DIR "/../shared/data/rndf/";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no shared data next to the sources";
  const Json facts = run_json({"check", folder + "darpa_sample/uce_rndf_1_final_event.rndf", "--json"});
  EXPECT_EQ(facts.number("/roads/points"), 941);
  EXPECT_EQ(facts.number("/roads/lane_waypoints"), 628);
  EXPECT_EQ(facts.number("/roads/checkpoints"), 170);
  EXPECT_EQ(facts.size("/warnings"), 0u);
}

}  // namespace

}  // namespace sf
