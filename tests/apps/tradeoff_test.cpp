// `tradeoff` and `--accuracy` as a user runs them.

#include <gtest/gtest.h>

#include "tests/apps/json.h"
#include "tests/apps/program.h"

namespace sf {
namespace {

void expect_says(const Outcome& outcome, const std::string& text) {
  EXPECT_NE((outcome.out + outcome.err).find(text), std::string::npos) << text << "\n" << outcome.out << outcome.err;
}

TEST(Tradeoff, ATableAFileAndAPicture) {
  const Folder folder;
  const Outcome outcome =
      run_program({"tradeoff", our_world("simville/simville.world"), "-o", folder.path("t"), "--max-error", "5mm"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  for (const char* text :
       {"skip4", "near3", "laneedge", "bound", "fastest with every error within 5 mm: --accuracy \""})
    expect_says(outcome, text);
  const std::string csv = read_file(folder.path("t/tradeoff.csv"));
  EXPECT_EQ(csv.find("sensor,mode,rate_per_s,median_error,p99_error,max_error,bound"), 0u);
  EXPECT_EQ(count_lines(csv), 1u + 5 + 3 + 4);
  EXPECT_EQ(read_file(folder.path("t/tradeoff.png")).substr(1, 3), "PNG");
}

TEST(Tradeoff, AutoPrintsTheWordsAlone) {
  const Outcome outcome = run_program({"tradeoff", our_world("rooms.world"), "--auto", "--max-error", "1nm"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "exact\n");
}

TEST(Tradeoff, WrongUsage) {
  EXPECT_EQ(run_program({"tradeoff"}).code, 2);
  const Outcome unit = run_program({"tradeoff", our_world("rooms.world"), "--max-error", "5"});
  EXPECT_EQ(unit.code, 2);
  expect_says(unit, "with its unit such as 5mm");
  EXPECT_EQ(run_program({"tradeoff", our_world("rooms.world"), "--min-rate", "fast"}).code, 2);
  EXPECT_EQ(run_program({"tradeoff", our_world("rooms.world")}, no_device()).code, 3);
  const Outcome nowhere = run_program({"tradeoff", our_world("rooms.world"), "-o", "/proc/none"});
  EXPECT_EQ(nowhere.code, 2);
  expect_says(nowhere, "/proc/none");
}

TEST(AccuracyOption, ChangesWhatIsReadAndSaysSo) {
  const Words sense{"sense", our_world("rooms.world"), "--json"};
  Words skip = sense;
  skip.insert(skip.end(), {"--accuracy", "skip2"});
  const Outcome exact = run_program(sense), some = run_program(skip);
  EXPECT_EQ(some.code, 0) << some.err;
  expect_says(exact, "\"accuracy\":\"exact\"");
  expect_says(some, "\"accuracy\":\"skip2\"");
  expect_says(some, "\"unsure\": \"not cast\"");
  EXPECT_EQ(exact.out.find("\"unsure\""), std::string::npos);
  expect_says(run_program({"check", our_world("rooms.world"), "--accuracy", "single"}), "laser single, within 998 um");
}

TEST(AccuracyOption, WrongWords) {
  const Outcome unknown = run_program({"check", our_world("rooms.world"), "--accuracy", "fast"});
  EXPECT_EQ(unknown.code, 2);
  expect_says(unknown, "there is no accuracy \"fast\"; expected one of \"exact\", \"single\"");
  const Outcome alone = run_program({"run", our_world("rooms.world"), "--max-error", "5mm"});
  EXPECT_EQ(alone.code, 2);
  expect_says(alone, "--auto");
  EXPECT_EQ(run_program({"run", our_world("rooms.world"), "--auto", "--accuracy", "skip2"}).code, 2);
}

TEST(AccuracyOption, AutoMeasuresFirst) {
  const Outcome outcome = run_program(
      {"run", our_world("rooms.world"), "--robots", "2", "--duration", "1", "--auto", "--max-error", "1nm"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  expect_says(outcome, "measured; with every error within 1 nm: --accuracy \"exact\"");
}

}  // namespace
}  // namespace sf
