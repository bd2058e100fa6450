// `tradeoff` and `--accuracy` as users run them.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/apps/json.h"
#include "tests/apps/program.h"
#include "tests/viz/png.h"

namespace sf {
namespace {

void expect_says(const Outcome& outcome, const std::string& text) {
  EXPECT_NE((outcome.out + outcome.err).find(text), std::string::npos) << text << "\n" << outcome.out << outcome.err;
}

/// Cells of a CSV file, line by line; an empty cell is NaN.
std::vector<std::vector<std::string>> cells_of(const std::string& csv) {
  std::vector<std::vector<std::string>> rows(1, {""});
  for (const char c : csv) {
    if (c == '\n') rows.push_back({""});
    if (c == ',') rows.back().emplace_back();
    if (c != ',' && c != '\n') rows.back().back() += c;
  }
  rows.pop_back();
  return rows;
}

double number(const std::string& cell) { return cell.empty() ? NAN : std::stod(cell); }

TEST(Tradeoff, WritesATableAFileAndAPicture) {
  const Folder folder;
  const Outcome outcome = run_successfully(
      {"tradeoff", our_world("simville/simville.world"), "-o", folder.path("t"), "--max-error", "5mm"});
  for (const char* text : {"covered by a stated bound ---", "--- errors of all ---",
                           "fastest with every error within 5 mm: --accuracy \""})
    expect_says(outcome, text);

  const auto rows = cells_of(read_file(folder.path("t/tradeoff.csv")));
  ASSERT_EQ(rows.size(), 1u + 5 + 3 + 4);
  EXPECT_EQ(rows[0], (std::vector<std::string>{"sensor", "mode", "rate_per_s", "covered", "covered_max_error",
                                               "covered_bound", "all_median_error", "all_p99_error", "all_max_error"}));
  const char* const names[] = {"laser exact",        "laser single",        "laser skip2",        "laser skip4",
                               "laser skip8",        "laneedge exact",      "laneedge skip2",     "laneedge skip4",
                               "magnetometer exact", "magnetometer near10", "magnetometer near3", "magnetometer near1"};
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const auto& row = rows[i];
    ASSERT_EQ(row.size(), 9u);
    const std::string name = row[0] + " " + row[1];
    EXPECT_EQ(name, names[i - 1]);
    expect_says(outcome, row[1]);
    EXPECT_GT(number(row[2]), 0.0) << name;
    EXPECT_LE(number(row[6]), number(row[7])) << name << ": median, 99 %";
    EXPECT_LE(number(row[7]), number(row[8])) << name << ": 99 %, largest";
    const double covered = number(row[3]);
    if (covered > 0.0) {
      EXPECT_LE(number(row[4]), number(row[5])) << name << ": within its bound";
      EXPECT_LE(number(row[4]), number(row[8])) << name;
      EXPECT_GT(number(row[5]), 0.0) << name;
    } else {
      EXPECT_EQ(row[4] + row[5], "") << name << ": neither error nor bound without covered values";
    }
    const bool leaves_out = row[1].rfind("skip", 0) == 0;
    EXPECT_EQ(covered < 1.0, leaves_out || name == "laneedge exact") << name << ": " << covered;
    EXPECT_TRUE(row[0] != "laneedge" || !leaves_out || covered == 0.0) << name;
  }
  EXPECT_NEAR(number(rows[4][3]), 0.25, 0.01) << "every fourth beam of 361";

  const scenes::Picture picture = scenes::read_png(folder.path("t/tradeoff.png"));
  EXPECT_EQ(picture.width, 1400);
  EXPECT_GT(picture.count(0xFF0072B2u), 3 * 80) << "a disc for the best of each type";
  EXPECT_GT(picture.count(0xFFD55E00u), 3 * 10) << "and the ring of a bound";
}

/// Its columns are the keys of the JSON output.
TEST(Tradeoff, JsonMatchesTheFile) {
  const Folder folder;
  const Json json(run_program({"tradeoff", our_world("rooms.world"), "-o", folder.path("t"), "--json"}).out);
  const auto rows = cells_of(read_file(folder.path("t/tradeoff.csv")));
  ASSERT_EQ(rows.size(), 1u + json.size("/modes"));
  for (std::size_t i = 1; i < rows.size(); ++i)
    for (std::size_t c = 2; c < rows[0].size(); ++c) {
      const std::string at = "/modes/" + std::to_string(i - 1) + "/" + rows[0][c];
      if (json.is_null(at)) {
        EXPECT_EQ(rows[i][c], "") << at;
      } else {
        EXPECT_NEAR(json.number(at), number(rows[i][c]), 1e-5 * json.number(at)) << at;
      }
    }
}

/// The terminal states the scope of a bound: a mode that leaves beams out shows how many it covers, and their error.
TEST(Tradeoff, BoundsAreShownWithTheErrorsThatTheyCover) {
  const Outcome outcome = run_successfully({"tradeoff", our_world("cave.world"), "--robots", "10"});
  const std::size_t at = outcome.out.find("laser         skip2");
  ASSERT_NE(at, std::string::npos) << outcome.out;
  const std::string line = outcome.out.substr(at, outcome.out.find('\n', at) - at);
  const std::size_t covered = line.find("50.1"), bound = line.find("1.05 nm"), largest = line.rfind(" m");
  ASSERT_NE(covered, std::string::npos) << line;
  ASSERT_NE(bound, std::string::npos) << line;
  EXPECT_LT(covered, bound) << line;
  EXPECT_LT(bound, largest) << "errors of all come last: " << line;
}

TEST(Tradeoff, AutoPrintsOnlyTheModes) {
  const Outcome outcome = run_successfully({"tradeoff", our_world("rooms.world"), "--auto", "--max-error", "1nm"});
  EXPECT_EQ(outcome.out, "exact\n");
}

TEST(Tradeoff, WrongUsageIsRejected) {
  EXPECT_EQ(run_program({"tradeoff"}).code, 2);
  const Outcome unit = run_program({"tradeoff", our_world("rooms.world"), "--max-error", "5"});
  EXPECT_EQ(unit.code, 2);
  expect_says(unit, "with its unit such as 5mm");
  EXPECT_EQ(run_program({"tradeoff", our_world("rooms.world"), "--min-rate", "fast"}).code, 2);
  EXPECT_EQ(run_program({"tradeoff", our_world("rooms.world"), "--require-vulkan"}, no_device()).code, 3);
  const Outcome nowhere = run_program({"tradeoff", our_world("rooms.world"), "-o", "/proc/none"});
  EXPECT_EQ(nowhere.code, 2);
  expect_says(nowhere, "/proc/none");
}

TEST(AccuracyOption, ChangesReadingsAndPrintsTheMode) {
  const Words sense{"sense", our_world("rooms.world"), "--json"};
  const Words skip = with(sense, {"--accuracy", "skip2"});
  const Outcome exact = run_program(sense), some = run_program(skip);
  EXPECT_EQ(some.code, 0) << some.err;
  expect_says(exact, "\"accuracy\":\"exact\"");
  expect_says(some, "\"accuracy\":\"skip2\"");
  expect_says(some, "\"unsure\":\"not cast\"");
  EXPECT_EQ(exact.out.find("\"unsure\""), std::string::npos);
  expect_says(run_program({"check", our_world("rooms.world"), "--accuracy", "single"}), "laser single, within 999 um");
}

TEST(AccuracyOption, RejectsUnknownModes) {
  const Outcome unknown = run_program({"check", our_world("rooms.world"), "--accuracy", "fast"});
  EXPECT_EQ(unknown.code, 2);
  expect_says(unknown, "--accuracy: there is no accuracy \"fast\"; expected one of \"exact\", \"single\"");
  for (const auto& [wish, value] : {std::pair("--max-error", "5mm"), {"--min-rate", "1"}, {"--by", "p99"}}) {
    const Outcome alone = run_program({"run", our_world("rooms.world"), "--duration", "0", wish, value});
    EXPECT_EQ(alone.code, 2) << wish;
    expect_says(alone, "--auto");
  }
  EXPECT_EQ(run_program({"run", our_world("rooms.world"), "--auto", "--accuracy", "skip2"}).code, 2);
}

TEST(AccuracyOption, AutoMeasuresFirst) {
  const Outcome outcome = run_successfully(
      {"run", our_world("rooms.world"), "--robots", "2", "--duration", "1", "--auto", "--max-error", "1nm"});
  expect_says(outcome, "measured; with every error within 1 nm: --accuracy \"exact\"");
}

/// A sensor type without a target has no bound; without any target, both have the default.
TEST(AccuracyOption, AutoPrintsItsTarget) {
  const std::vector<std::pair<Words, std::string>> wishes{
      {{}, "with every error within 10 mm and 1 uT: "},
      {{"--max-error", "2uT"}, "with every error within 2 uT: "},
      {{"--max-error", "999.7um", "--by", "median"}, "with a median error within 1 mm: "},  // not 1e+03 um
      {{"--max-error", "5mm", "--by", "p99"}, "with 99 % of errors within 5 mm: "},
      {{"--min-rate", "1"}, "at 1 Hz or more: "},
  };
  for (const auto& [wish, message] : wishes) {
    const Words words = with({"run", our_world("rooms.world"), "--duration", "0", "--auto"}, wish);
    expect_says(run_program(words), "measured; " + message + "--accuracy \"");
  }
}

}  // namespace
}  // namespace sf
