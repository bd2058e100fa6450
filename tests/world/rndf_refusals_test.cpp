// Errors are rejected with their line and the expected text. In strict mode, so are all deviations.

#include <gtest/gtest.h>

#include "tests/world/rndf_text.h"
#include "world/roads/rndf.h"

namespace sf::world {
namespace {

struct Wrong {
  std::string from, to;  ///< the first `from` of the small network is replaced by `to`
  std::string error;     ///< start of the error
};

void expect_refused(const std::vector<Wrong>& corpus) {
  EXPECT_EQ(refusal_of(std::string(kSmallRndf)), "");
  for (const Wrong& wrong : corpus) {
    const std::string error = refusal_of(small_with(wrong.from, wrong.to));
    EXPECT_EQ(error.substr(0, wrong.error.size()), wrong.error) << wrong.from << " -> " << wrong.to;
  }
}

TEST(RndfRefusals, Ids) {
  expect_refused({
      {"zone 3\n", "zone 2\n", "small.rndf:39: zone or segment 2 is already in line 30"},
      {"lane 1.2\n", "lane 2.2\n", "small.rndf:21: lane 2.2 is in segment 1; expected 1.1"},
      {"lane 1.2\n", "lane 1.0\n", "small.rndf:21: lane 1.0 is in segment 1"},
      {"spot 3.1\n", "spot 4.1\n", "small.rndf:50: spot 4.1 is in zone 3"},
      {"spot 3.1\n", "spot 3.0\n", "small.rndf:50: spot 3.0 is in zone 3"},
      {"perimeter 3.0\n", "perimeter 3.1\n", "small.rndf:42: perimeter 3.1 is in zone 3; expected 3.0"},
      {"1.1.2 40", "1.2.2 40", "small.rndf:18: way-point 1.2.2 is in lane 1.1; expected 1.1.1, 1.1.2"},
      {"1.1.2 40", "1.1.0 40", "small.rndf:18: way-point 1.1.0 is in lane 1.1"},
      {"3.0.2 40", "3.1.2 40", "small.rndf:46: way-point 3.1.2 is in perimeter 3.0"},
      {"1.1.1 40", "1.1.4 40", "small.rndf:18: way-point 1.1.2 follows 1.1.4; expected them in driving direction"},
      {"stop 1.1.3\n", "stop 1.1.3\nstop 1.1.3\n", "small.rndf:16: stop 1.1.3 is given twice"},
      {"exit 1.1.3 2.1.1\n", "exit 1.1.3 2.1.1\nexit 1.1.3 2.1.1\n",
       "small.rndf:17: exit 1.1.3 to 2.1.1 is already in line 16"},
  });
}

TEST(RndfRefusals, References) {
  expect_refused({
      {"exit 1.1.3 2.1.1", "exit 1.1.3 2.1.9",
       "small.rndf:16: the exit leads to way-point 2.1.9, which does not exist"},
      {"exit 1.1.3 2.1.1", "exit 1.1.4 2.1.1", "small.rndf:16: the exit leaves way-point 1.1.4, which does not exist"},
      {"exit 1.1.3 2.1.1", "exit 1.2.1 2.1.1", "small.rndf:16: exit 1.2.1 is in lane 1.1"},
      {"exit 3.0.3", "exit 3.0.5", "small.rndf:44: the exit leaves way-point 3.0.5, which does not exist"},
      {"exit 2.1.2 3.0.1", "exit 2.1.2 3.0.5", "small.rndf:34: the exit leads to way-point 3.0.5"},
      {"checkpoint 1.1.2 1", "checkpoint 1.1.9 1", "small.rndf:14: checkpoint 1 names way-point 1.1.9"},
      {"checkpoint 1.1.2 1", "checkpoint 1.2.1 1", "small.rndf:14: checkpoint 1.2.1 is in lane 1.1"},
      {"checkpoint 3.1.2 2", "checkpoint 3.1.3 2", "small.rndf:52: checkpoint 2 names way-point 3.1.3"},
      {"stop 1.1.3", "stop 1.1.4", "small.rndf:15: the stop names way-point 1.1.4, which does not exist"},
  });
}

TEST(RndfRefusals, Counts) {
  expect_refused({
      {"num_segments 2", "num_segments 3", "small.rndf:2: 'num_segments' is 3, but the file has 2"},
      {"num_segments 2", "num_segments 1", "small.rndf:2: 'num_segments' is 1, but the file has 2"},
      {"num_segments 2\n", "", "small.rndf:1: 'num_segments' is missing in the file; expected 'num_segments 2'"},
      {"num_zones 1", "num_zones 0", "small.rndf:3: 'num_zones' is 0, but the file has 1"},
      {"num_lanes 2", "num_lanes 1", "small.rndf:7: 'num_lanes' is 1, but segment 1 has 2"},
      {"num_waypoints 3", "num_waypoints 4", "small.rndf:10: 'num_waypoints' is 4, but lane 1.1 has 3"},
      {"num_waypoints 3\n", "", "small.rndf:9: 'num_waypoints' is missing in lane 1.1"},
      {"num_spots 1", "num_spots 2", "small.rndf:40: 'num_spots' is 2, but zone 3 has 1"},
      {"num_perimeterpoints 4", "num_perimeterpoints 3",
       "small.rndf:43: 'num_perimeterpoints' is 3, but perimeter 3.0 has 4"},
      {"3.1.2 40.001350 -82.997500\n", "", "small.rndf:50: spot 3.1 has 1 points; expected two"},
      {"3.1.2 40.001350 -82.997500\n", "3.1.2 40.001350 -82.9975\n3.1.3 40.0014 -82.9975\n",
       "small.rndf:50: spot 3.1 has 3 points; expected two"},
  });
}

// Only the lists of zones and spots may be empty, with or without a declared count.
TEST(RndfRefusals, OnlyZonesAndSpotsMayBeEmpty) {
  const std::string head = "RNDF_name x\nnum_segments 1\nnum_zones 0\n";
  EXPECT_NE(refusal_of("RNDF_name x\nend_file\n").find("'num_segments' is missing"), std::string::npos);
  EXPECT_NE(refusal_of(head + "segment 1\nend_segment\nend_file\n").find(":4: 'num_lanes' is missing"),
            std::string::npos);
  EXPECT_NE(refusal_of(head + "segment 1\nnum_lanes 1\nlane 1.1\nend_lane\nend_segment\nend_file\n")
                .find(":6: 'num_waypoints' is missing"),
            std::string::npos);
  EXPECT_NE(refusal_of(with(with(small_with("num_perimeterpoints 4\nexit 3.0.3 1.2.1\n", ""), "exit 2.1.2 3.0.1\n", ""),
                            "3.0.1 40.001100 -82.997900\n3.0.2 40.001100 -82.997000\n3.0.3 40.001600 -82.997000\n3.0.4 "
                            "40.001600 -82.997900\n",
                            ""))
                .find("'num_perimeterpoints' is missing"),
            std::string::npos);
  EXPECT_EQ(
      refusal_of(with(head, "num_zones 0\n", "") +
                 "segment 1\nnum_lanes 1\nlane 1.1\nnum_waypoints 1\n1.1.1 0 0\nend_lane\nend_segment\nend_file\n"),
      "");
}

TEST(RndfRefusals, Numbers) {
  expect_refused({
      {"num_segments 2", "num_segments", "small.rndf:2: the number of segments is missing after 'num_segments'"},
      {"num_segments 2", "num_segments two",
       "small.rndf:2: the number of segments is 'two'; expected a whole number from 1"},
      {"num_segments 2", "num_segments 0", "small.rndf:2: the number of segments is '0'"},
      {"num_segments 2", "num_segments -2", "small.rndf:2: the number of segments is '-2'"},
      {"num_segments 2", "num_segments 2.5", "small.rndf:2: the number of segments is '2.5'"},
      {"num_segments 2", "num_segments 32769", "small.rndf:2: the number of segments is '32769'"},
      {"num_segments 2", "num_segments 99999999999999999999", "small.rndf:2: the number of segments is '9999"},
      {"num_segments 2", "num_segments 2 2", "small.rndf:2: '2' was not expected after '2'"},
      {"num_waypoints 3", "num_waypoints 0", "small.rndf:10: the number of way-points is '0'"},
      {"lane_width 12", "lane_width -12", "small.rndf:11: the width is '-12'"},
      {"lane_width 12", "lane_width 12ft", "small.rndf:11: the width is '12ft'; expected a number"},
      {"lane_width 12", "lane_width 40000", "small.rndf:11: the width is '40000'"},
      {"checkpoint 1.1.2 1", "checkpoint 1.1.2 0", "small.rndf:14: the checkpoint's id is '0'"},
      {"checkpoint 1.1.2 1", "checkpoint 1.1.2", "small.rndf:14: the checkpoint's id is missing"},
      {"40.000000 -83.000000", "91.000000 -83.000000",
       "small.rndf:17: the latitude is '91.000000'; expected degrees from -90 to 90"},
      {"40.000000 -83.000000", "-90.0001 -83.000000", "small.rndf:17: the latitude is '-90.0001'"},
      {"40.000000 -83.000000", "1e999 -83.000000", "small.rndf:17: the latitude is '1e999'"},
      {"40.000000 -83.000000", "40.000000 -181.000000", "small.rndf:17: the longitude is '-181.000000'"},
      {"40.000000 -83.000000", "nan -83.000000", "small.rndf:17: the latitude is 'nan'; expected a number"},
      {"40.000000 -83.000000", "40.000000 inf", "small.rndf:17: the longitude is 'inf'"},
      {"40.000000 -83.000000", "40.000000", "small.rndf:17: the longitude is missing"},
      {"40.000000 -83.000000", "40,000000 -83,000000", "small.rndf:17: the latitude is '40,000000'"},
      {"40.000000 -83.000000", "40.000000 -83.000000 5", "small.rndf:17: '5' was not expected"},
      {"1.1.1 40", "1.1 40", "small.rndf:17: the way-point is '1.1'; expected three numbers separated by dots"},
      {"1.1.1 40", "1.1.1.1 40", "small.rndf:17: the way-point is '1.1.1.1'"},
      {"1.1.1 40", "1.1.99999 40", "small.rndf:17: the way-point is '1.1.99999'"},
      {"exit 1.1.3 2.1.1", "exit 1.1.3", "small.rndf:16: the entry of this exit is missing"},
      {"left_boundary double_yellow", "left_boundary dashed",
       "small.rndf:12: 'left_boundary' is 'dashed'; expected one of double_yellow, solid_yellow, solid_white, "
       "broken_white"},
      {"left_boundary double_yellow", "left_boundary", "small.rndf:12: 'left_boundary' is ''; expected one of"},
  });
}

TEST(RndfRefusals, Places) {
  expect_refused({
      {"segment 1\n", "stop 1.1.3\nsegment 1\n", "small.rndf:6: 'stop' is in the file; expected it in a lane"},
      {"num_lanes 2\n", "num_lanes 2\nexit 1.1.3 2.1.1\n",
       "small.rndf:8: 'exit' is in segment 1; expected it in a lane or a perimeter"},
      {"segment 1\n", "1.1.1 40 -83\nsegment 1\n",
       "small.rndf:6: '1.1.1' is in the file; expected way-points only in lanes"},
      {"segment 1\n", "lane 1.1\nsegment 1\n", "small.rndf:6: 'lane' is in the file; expected it in a segment"},
      {"end_zone\n", "end_zone\nend_zone\n", "small.rndf:57: 'end_zone' is in the file; expected it in a zone"},
      {"RNDF_name small\n", "", "small.rndf: 'RNDF_name' is missing"},
      {"zone_name Lot\nperimeter 3.0\n", "zone_name Lot\n/*", "small.rndf:42: this comment is never closed"},
      {"exit 1.1.3 2.1.1", "/* exit 1.1.3 2.1.1", "small.rndf:16: this comment is never closed; expected */"},
  });
}

TEST(RndfRefusals, OtherFiles) {
  EXPECT_EQ(refusal_of(""), "small.rndf: 'RNDF_name' is missing; expected a route network definition file");
  EXPECT_NE(refusal_of("MDF_name x\nRNDF y\n").find("this is an MDF"), std::string::npos);
  EXPECT_NE(refusal_of("hello world\n").find("'RNDF_name' is missing"), std::string::npos);
  EXPECT_NE(refusal_of("{\"json\": 1}\n").find(":1: '{\"json\":' is not a statement"), std::string::npos);
  EXPECT_NE(refusal_of("\x89PNG\r\n\x1a\n").find(":1: "), std::string::npos);
  EXPECT_NE(refusal_of(std::string("RNDF_name x\nnum\0segments", 24)).find(":2: byte 0x00 is not text"),
            std::string::npos);
  EXPECT_NE(refusal_of(std::string(5'000'000, 'a')).find("is not a statement"), std::string::npos);
  std::string words;
  for (char a = 'a'; a <= 'z'; ++a)
    for (char b = 'a'; b <= 'z'; ++b) words += std::string{a, b, '\n'};
  EXPECT_NE(refusal_of(words).find("unknown keywords; is this an RNDF?"), std::string::npos);
}

TEST(RndfRefusals, MissingFile) {
  EXPECT_THROW(read_rndf("/nowhere/x.rndf"), base::InputError);
  EXPECT_THROW(read_rndf("/dev/zero"), base::InputError);
  EXPECT_THROW(read_rndf("/"), base::InputError);
}

}  // namespace
}  // namespace sf::world
