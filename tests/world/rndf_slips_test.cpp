// Mistakes in hand-written files. Unambiguous ones are accepted with a warning, all others are rejected together.

#include <gtest/gtest.h>

#include <set>

#include "tests/world/rndf_text.h"
#include "tests/world/successors.h"
#include "world/roads/mdf.h"
#include "world/roads/network.h"

namespace sf::world {
namespace {

struct Slip {
  std::string from, to;  ///< the first `from` of the small network is replaced by `to`
  std::string warning;   ///< the only warning, in full
};

// Each mistake is rejected in strict mode. Otherwise it does not change any number of the network.
TEST(RndfSlips, UnambiguousMistakesAreWarnings) {
  const RoadCounts fine = count(small_rndf());
  const std::vector<Slip> corpus{
      {"num_waypoints 3", "num_waypoints 122", "10: 'num_waypoints' is 122, but lane 1.1 has 3; 3 are used"},
      {"num_waypoints 3", "num_waypoints 2", "10: 'num_waypoints' is 2, but lane 1.1 has 3; 3 are used"},
      {"num_waypoints 3\n", "", "9: 'num_waypoints' is missing in lane 1.1; 3 are used"},
      {"num_waypoints 3", "num_waypoints many",
       "10: 'num_waypoints' is 'many', not a number above zero; the actual entries are counted"},
      {"num_lanes 2\n", "", "6: 'num_lanes' is missing in segment 1; 2 are used"},
      {"num_lanes 2\n", "num_lanes 2\nnum_lanes 3\n", "8: 'num_lanes' is given twice in segment 1; the first is used"},
      {"num_segments 2", "num_segments 3", "2: 'num_segments' is 3, but the file has 2; 2 are used"},
      {"num_zones 1", "num_zones 0", "3: 'num_zones' is 0, but the file has 1; 1 is used"},
      {"num_spots 1", "num_spots 9", "40: 'num_spots' is 9, but zone 3 has 1; 1 is used"},
      {"num_perimeterpoints 4", "num_perimeterpoints 5",
       "43: 'num_perimeterpoints' is 5, but perimeter 3.0 has 4; 4 are used"},
      {"RNDF_name small\n", "", "0: 'RNDF_name' is missing; it has no name"},
      {"exit 3.0.3 1.2.1", "exit 1.2.2 3.0.1", "44: exit 1.2.2 is in perimeter 3.0; it is assigned to 1.2"},
      {"exit 1.1.3 2.1.1", "exit 1.2.2 2.1.1", "16: exit 1.2.2 is in lane 1.1; it is assigned to 1.2"},
      {"stop 1.1.3", "stop 1.2.2", "15: stop 1.2.2 is in lane 1.1; it is assigned to 1.2"},
      {"checkpoint 1.1.2 1", "checkpoint 1.2.2 1", "14: checkpoint 1.2.2 is in lane 1.1; it is assigned to 1.2"},
      {"exit 1.1.3 2.1.1\n", "exit 1.1.3 2.1.1\nexit 1.1.3 2.1.1\n",
       "17: exit 1.1.3 to 2.1.1 is already in line 16; it is used once"},
      {"stop 1.1.3\n", "stop 1.1.3\nstop 1.1.3\n", "16: stop 1.1.3 is given twice; it is used once"},
      {"checkpoint 1.1.2 1\n", "checkpoint 1.1.2 1\ncheckpoint 1.1.2 1\n",
       "15: checkpoint 1 is already in line 14; it is used once"},
      {"lane_width 12\n", "lane_width 12\nlane_width 12\n",
       "12: 'lane_width' is given twice in lane 1.1; the first is used"},
      {"lane_width 12", "lane_width 12 feet",
       "11: 'feet' was not expected after '12'; it and the rest of the line are ignored"},
      {"1.1.1 40.000000 -83.000000", "1.1.1 40.000000 -83.000000 (corner)",
       "17: '(corner)' was not expected after '-83.000000'; it and the rest of the line are ignored"},
      {"left_boundary double_yellow", "left_boundary", "12: 'left_boundary' is ''; assuming no marking"},
  };
  for (const Slip& slip : corpus) {
    const std::string text = small_with(slip.from, slip.to);
    EXPECT_NE(refusal_of(text), "") << slip.to << ": strictly it is wrong";
    ASSERT_EQ(refusal_of(text, false), "") << slip.to;
    const Rndf rndf = parse_rndf("small.rndf", text);
    EXPECT_EQ(lines_of(rndf.warnings), slip.warning + "\n") << slip.to;
    const RoadCounts c = count(rndf);
    EXPECT_EQ(c.points, fine.points) << slip.to;
    EXPECT_EQ(c.lanes, fine.lanes) << slip.to;
    EXPECT_EQ(c.exits, fine.exits) << slip.to;
    EXPECT_EQ(c.stops, fine.stops) << slip.to;
    EXPECT_EQ(c.checkpoints, fine.checkpoints) << slip.to;
    std::vector<Warning> warnings;
    EXPECT_EQ(build_network(rndf, {}, warnings).exits.size(), fine.exits) << slip.to;
  }
}

TEST(RndfSlips, ExitOfTheNeighbourLeavesTheNeighbour) {
  std::vector<Warning> warnings;
  const RoadNetwork roads =
      build_network(parse_rndf("x", small_with("exit 1.1.3 2.1.1", "exit 1.2.2 2.1.1")), {}, warnings);
  const auto from = find_point(roads, {1, 2, 2});
  ASSERT_TRUE(from.has_value());
  const std::vector<Transition> steps = successors(roads, *from);
  ASSERT_EQ(steps.size(), 1u);
  EXPECT_EQ(id_of(roads, steps[0].to), (PointId{2, 1, 1}));
}

TEST(RndfSlips, AmbiguousMistakesAreRejected) {
  const std::vector<std::pair<std::pair<std::string, std::string>, std::string>> corpus{
      {{"exit 1.1.3 2.1.1", "exit 1.1.3 9.1.1"}, "small.rndf:16: the exit leads to way-point 9.1.1, which does not"},
      {{"exit 1.1.3 2.1.1", "exit 1.1.3 3.1.1"}, "small.rndf:16: the exit leads to 3.1.1, a point of a parking spot"},
      {{"stop 1.1.3", "stop 3.0.1"}, "small.rndf:15: the stop names 3.0.1; expected a way-point of a lane"},
      {{"checkpoint 1.1.2 1", "checkpoint 3.0.1 1"}, "small.rndf:14: checkpoint 1 names 3.0.1, a point of a zone's"},
      {{"checkpoint 3.1.2 2", "checkpoint 3.1.2 1"},
       "small.rndf:52: checkpoint 1 is already in line 14; expected a unique id"},
      {{"lane 1.2\n", "lane 1.1\n"}, "small.rndf:21: lane 1.1 is already in line 9"},
      {{"lane 1.2\n", "lane one\n"}, "small.rndf:21: the lane's id is 'one'"},
      {{"segment 2\n", "segment 1\n"}, "small.rndf:30: segment 1 is already in line 6"},
      {{"1.1.2 40", "1.1.1 40"}, "small.rndf:18: way-point 1.1.1 is already in line 17"},
      {{"1.1.2 40", "1.2.2 40"}, "small.rndf:18: way-point 1.2.2 is in lane 1.1"},
      {{"lane_width 12\n", "lane_width 12\nlane_width 13\n"}, "small.rndf:12: 'lane_width' is given twice in lane 1.1"},
      {{"left_boundary double_yellow", "left_boundary dashed"}, "small.rndf:12: 'left_boundary' is 'dashed'"},
      {{"1.2.1 40.000050 -82.998000\n1.2.2 40.000050 -83.000000\n", ""},
       "small.rndf:22: 'num_waypoints' is 2, but lane 1.2 has 0"},
      {{"num_waypoints 2\nlane_width 12\nleft_boundary double_yellow\nright_boundary broken_white\n1.2.1 40.000050 "
        "-82.998000\n1.2.2 40.000050 -83.000000\n",
        "num_waypoints none\n"},
       "small.rndf:22: 'num_waypoints' is none, but lane 1.2 has 0"},
  };
  const std::set<std::string> tolerant_only{"stop 3.0.1", "checkpoint 3.0.1 1", "num_waypoints none\n"};
  for (const auto& [change, error] : corpus) {
    // A point with a wrong number is missing elsewhere, so more errors may follow unless the first one ends it.
    for (const bool strict : {false, true})
      if (!strict || !tolerant_only.contains(change.second))
        expect_in("\n" + error, "\n" + refusal_of(small_with(change.first, change.second), strict));
  }
}

// A file that ends in the middle is truncated, whatever its counts say. It is not accepted with a warning.
TEST(RndfSlips, TruncatedFileIsRejected) {
  const std::string whole(kSmallRndf);
  const std::string cut = refusal_of(whole.substr(0, whole.find("1.1.3 40")), false);
  EXPECT_NE(cut.find("small.rndf:10: 'num_waypoints' is 3, but lane 1.1 has 2: the file is truncated"),
            std::string::npos)
      << cut;
  EXPECT_NE(cut.find("small.rndf:2: 'num_segments' is 2, but the file has 1: the file is truncated"), std::string::npos)
      << cut;
}

TEST(RndfSlips, AllProblemsAreReportedInOneRun) {
  std::string text = small_with("exit 1.1.3 2.1.1", "exit 1.1.3 9.1.1");
  text = with(text, "num_lanes 2", "num_lanes 7");
  text = with(text, "2.1.2 40.001000", "2.1.2 41,001000");
  text = with(text, "spot_width 10", "spot_width wide");
  EXPECT_EQ(refusal_of(text, false),
            "small.rndf:16: the exit leads to way-point 9.1.1, which does not exist; expected one of this file\n"
            "small.rndf:36: the latitude is '41,001000'; expected a number such as -77.205045\n"
            "small.rndf:51: the width is 'wide'; expected a number such as -77.205045\n"
            "small.rndf:7: warning: 'num_lanes' is 7, but segment 1 has 2; 2 are used\n"
            "small.rndf: 3 problems without a clear meaning: the file is not used");
  EXPECT_EQ(refusal_of(text),
            "small.rndf:7: 'num_lanes' is 7, but segment 1 has 2; correct the number, or add or remove entries")
      << "strictly the first one ends it";
}

// A lane whose first line is rejected is skipped as a whole, so its lines cause no further errors.
TEST(RndfSlips, OneMistakeIsOneProblem) {
  for (const std::string lane : {"lane x.2\n", "lane 1.1\n", "lane 7.2\n"}) {
    const std::string said = refusal_of(small_with("lane 1.2\n", lane), false);
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;
  }
}

// Lanes of a segment without a header are not zones.
TEST(RndfSlips, RejectedLanesAreNotZones) {
  const std::string said = refusal_of(small_with("segment 1\n", ""), false);
  EXPECT_NE(said.find("'num_segments' is 2, but the file has 1"), std::string::npos) << said;
  EXPECT_EQ(said.find("num_zones"), std::string::npos) << said;
}

TEST(RndfSlips, StopsAfterAHundredProblems) {
  std::string text(kSmallRndf);
  std::string more;
  for (int i = 0; i < 1000; ++i) more += "exit 1.1.3 x\n";
  const std::string said = refusal_of(with(text, "stop 1.1.3\n", more), false);
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 100);
  EXPECT_NE(said.find("100 problems and more"), std::string::npos);
}

TEST(RndfSlips, StopsAfterTenThousandWarnings) {
  const auto slips = [](int count) {
    std::string more = "stop 1.1.3\n";
    for (int i = 0; i < count; ++i) more += "stop 1.1.3\n";
    return refusal_of(with(std::string(kSmallRndf), "stop 1.1.3\n", more), false);
  };
  EXPECT_EQ(slips(10'000), "");
  EXPECT_NE(slips(10'001).find("stop 1.1.3 is given twice, after 10000 warnings; is this the right file?"),
            std::string::npos);
}

const std::string kMission =
    "MDF_name go\nRNDF small\ncheckpoints\nnum_checkpoints 2\n1\n2\nend_checkpoints\nspeed_limits\n"
    "num_speed_limits 2\n1 0 15\n3 5 25\nend_speed_limits\nend_file\n";

TEST(MdfSlips, UnambiguousMistakesAreWarnings) {
  const std::vector<Slip> corpus{
      {"num_speed_limits 2", "num_speed_limits 68", "9: 'num_speed_limits' is 68, but there are 2; 2 are used"},
      {"num_speed_limits 2\n", "", "0: 'num_speed_limits' is missing; 2 are used"},
      {"num_checkpoints 2", "num_checkpoints 1", "4: 'num_checkpoints' is 1, but there are 2; 2 are used"},
      {"num_checkpoints 2", "num_checkpoints",
       "4: 'num_checkpoints' is '', not a number; the actual entries are counted"},
      {"MDF_name go\n", "", "0: 'MDF_name' is missing; it has no name"},
      {"RNDF small\n", "RNDF small\nRNDF_name small\n", "3: 'RNDF_name' is given twice; the first is used"},
      {"1 0 15\n", "1 0 15 mph\n", "10: 'mph' was not expected after '15'; it and the rest of the line are ignored"},
      {"1 0 15\n", "1 0 15\n1 0 15\n", "11: 1 already has a speed limit in line 10; it is used once"},
  };
  for (const Slip& slip : corpus) {
    const std::string text = with(kMission, slip.from, slip.to);
    EXPECT_THROW(parse_mdf("go.mdf", text, true), base::InputError) << slip.to;
    const Mdf mdf = parse_mdf("go.mdf", text);
    const std::string said = lines_of(mdf.warnings);
    EXPECT_EQ(said.substr(0, slip.warning.size()), slip.warning) << slip.to;
    EXPECT_EQ(mdf.checkpoints.size(), 2u) << slip.to;
    EXPECT_EQ(mdf.speed_limits.size(), 2u) << slip.to;
  }
}

TEST(MdfSlips, AmbiguousMistakesAreRejectedTogether) {
  const std::string text = with(with(kMission, "\n2\n", "\n2 3\n"), "3 5 25", "3 25 5");
  const std::string said = sf::refusal_of([&] { parse_mdf("go.mdf", text); });
  EXPECT_TRUE(said.starts_with("go.mdf:6: '3' was not expected after '2'")) << said;
  expect_in("\ngo.mdf:11: speeds from 25 to 5", said);
  EXPECT_THROW(parse_mdf("go.mdf", with(kMission, "1 0 15\n", "1 0 15\n1 0 20\n")), base::InputError);
  EXPECT_THROW(parse_mdf("go.mdf", kMission.substr(0, kMission.find("3 5 25"))), base::InputError) << "cut short";
}

TEST(MdfSlips, AllMissingCheckpointsAreListed) {
  const Mdf mdf = parse_mdf("go.mdf", with(kMission, "\n1\n2\n", "\n7\n8\n"));
  const std::string said = sf::refusal_of([&] { check_against(mdf, small_rndf()); });
  expect_in("go.mdf:5: checkpoint 7 does not exist in small.rn", said);
  expect_in("go.mdf:6: checkpoint 8", said);
}

}  // namespace
}  // namespace sf::world
