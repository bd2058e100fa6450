// Missions: their syntax, and their checks against a network.

#include "world/roads/mdf.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/world/rndf_text.h"

namespace sf::world {
namespace {

const std::string kSmallMdf = R"(MDF_name go
RNDF small
format_version 1.0
creation_date 10/25/2007 6:30:28 PM
checkpoints
num_checkpoints 3
1
2
1
end_checkpoints
speed_limits
num_speed_limits 2
1 0 15
3 5 25
end_speed_limits
end_file
)";

std::string mdf_with(const std::string& from, const std::string& to) { return with(kSmallMdf, from, to); }

std::string mdf_refusal(const std::string& text, bool strict = true) {
  return sf::refusal_of([&] { parse_mdf("go.mdf", text, strict); });
}

TEST(Mdf, EveryStatementIsRead) {
  const Mdf mdf = parse_mdf("go.mdf", kSmallMdf);
  EXPECT_EQ(mdf.name, "go");
  EXPECT_EQ(mdf.rndf_name, "small");
  EXPECT_EQ(mdf.creation_date, "10/25/2007 6:30:28 PM");
  ASSERT_EQ(mdf.checkpoints.size(), 3u);  // in order, including repeats
  EXPECT_EQ(mdf.checkpoints[0].id, 1);
  EXPECT_EQ(mdf.checkpoints[1].id, 2);
  EXPECT_EQ(mdf.checkpoints[2].id, 1);
  ASSERT_EQ(mdf.speed_limits.size(), 2u);
  EXPECT_EQ(mdf.speed_limits[1].id, 3);
  EXPECT_EQ(mdf.speed_limits[1].least_mph, 5.0);
  EXPECT_EQ(mdf.speed_limits[1].most_mph, 25.0);
  EXPECT_TRUE(mdf.warnings.empty()) << lines_of(mdf.warnings);
  EXPECT_TRUE(check_against(mdf, small_rndf()).empty());
}

TEST(Mdf, RealFileVariantsChangeNothing) {
  for (const std::string& text : {mdf_with("RNDF small", "RNDF_name small"), mdf_with("15\n", "15\t\t\r\n"),
                                  mdf_with("1\n2\n", "1\t\n\n2 /* lot */\n"), mdf_with("format_version 1.0\n", ""),
                                  mdf_with("creation_date 10/25/2007 6:30:28 PM\n", "")}) {
    const Mdf mdf = parse_mdf("go.mdf", text);
    EXPECT_TRUE(mdf.warnings.empty()) << text << lines_of(mdf.warnings);
    EXPECT_EQ(mdf.rndf_name, "small") << text;
    EXPECT_EQ(mdf.checkpoints.size(), 3u) << text;
    EXPECT_EQ(mdf.speed_limits.size(), 2u) << text;
  }
}

TEST(Mdf, MissingEndsAreWarnings) {
  const std::vector<std::pair<std::string, std::string>> corpus{
      {"end_checkpoints\n", "5: 'checkpoints' has no 'end_checkpoints'; it ends before 'speed_limits'\n"},
      {"end_speed_limits\n", "11: 'speed_limits' has no 'end_speed_limits'; it ends before 'end_file'\n"},
      {"end_file\n", "15: 'end_file' is missing at the end of the file\n"}};
  for (const auto& [end, warning] : corpus)
    EXPECT_EQ(lines_of(parse_mdf("go.mdf", mdf_with(end, "")).warnings), warning) << end;
  // Truncated inside a block: reports the line where the block starts.
  const std::string cut = kSmallMdf.substr(0, kSmallMdf.find("end_speed_limits"));
  EXPECT_EQ(lines_of(parse_mdf("go.mdf", cut).warnings),
            "11: 'speed_limits' has no 'end_speed_limits'; it ends at the end of the file\n"
            "14: 'end_file' is missing at the end of the file\n");
}

TEST(Mdf, WrongFilesAreRejected) {
  const std::vector<std::tuple<std::string, std::string, std::string>> corpus{
      {"num_checkpoints 3", "num_checkpoints 4", "go.mdf:6: 'num_checkpoints' is 4, but there are 3"},
      {"num_checkpoints 3\n", "", "go.mdf: 'num_checkpoints' is missing"},
      {"num_speed_limits 2", "num_speed_limits 1", "go.mdf:12: 'num_speed_limits' is 1, but there are 2"},
      {"MDF_name go\n", "", "go.mdf: 'MDF_name' is missing"},
      {"MDF_name go\n", "MDF_name go\nMDF_name go\n", "go.mdf:2: 'MDF_name' is given twice"},
      {"RNDF small\n", "RNDF small\nRNDF_name small\n", "go.mdf:3: 'RNDF_name' is given twice"},
      {"\n2\n", "\n0\n", "go.mdf:8: the checkpoint's id is '0'; expected a whole number from 1"},
      {"\n2\n", "\n2 3\n", "go.mdf:8: '3' was not expected"},
      {"\n2\n", "\n2.5\n", "go.mdf:8: the checkpoint's id is '2.5'"},
      {"1 0 15", "1 0", "go.mdf:13: the highest speed is missing"},
      {"1 0 15", "1 20 15", "go.mdf:13: speeds from 20 to 15 miles per hour"},
      {"1 0 15", "1 -5 15", "go.mdf:13: speeds from -5 to 15"},
      {"1 0 15", "1 0 fast", "go.mdf:13: the highest speed is 'fast'"},
      {"3 5 25", "1 5 25", "go.mdf:14: 1 already has a speed limit in line 13"},
      {"checkpoints\n", "5\ncheckpoints\n", "go.mdf:5: '5' is outside any list"},
      {"end_checkpoints", "end_speed_limits", "go.mdf:10: 'end_speed_limits' has no matching start"},
      {"checkpoints\n", "num_segments 3\n", "go.mdf:5: 'num_segments' belongs in an RNDF; expected an MDF"},
      {"checkpoints\n", "/* checkpoints\n", "go.mdf:5: this comment is never closed"},
      {"checkpoints\n", "(checkpoints)\n", "go.mdf:5: '(checkpoints)' is not a statement"}};
  for (const auto& [from, to, error] : corpus)
    EXPECT_EQ(mdf_refusal(mdf_with(from, to)).substr(0, error.size()), error) << from << " -> " << to;
  EXPECT_EQ(mdf_refusal(kSmallMdf), "");
}

TEST(Mdf, UnknownSpeedLimitsAreWarnings) {
  const auto warnings = check_against(parse_mdf("go.mdf", mdf_with("3 5 25", "9 5 25")), small_rndf());
  EXPECT_EQ(lines_of(warnings), "14: speed limit for 9, but small.rndf has no such segment or zone\n");
}

TEST(MdfFiles, TexasMissions) {
  const std::string folder = SF_SOURCE_DIR "/../shared/data/rndf/utexas/";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no shared data next to the sources";
  const Mdf swri = read_mdf(folder + "swri_site_visit.mdf");
  EXPECT_TRUE(swri.warnings.empty());
  EXPECT_TRUE(check_against(swri, read_rndf(folder + "swri_site_visit.rndf")).empty());

  // Two ends are missing, and one speed limit is for zone 8, which its network does not have.
  const Mdf large = read_mdf(folder + "prc_large.mdf");
  EXPECT_EQ(large.warnings.size(), 2u) << lines_of(large.warnings);
  EXPECT_EQ(check_against(large, read_rndf(folder + "prc_large.rndf")).size(), 1u);

  // The same mission on another network, which has none of its checkpoints.
  const Mdf osm = read_mdf(folder + "prc_osm.mdf");
  EXPECT_THROW(check_against(osm, read_rndf(folder + "prc_osm.rndf")), base::InputError);
}

}  // namespace
}  // namespace sf::world
