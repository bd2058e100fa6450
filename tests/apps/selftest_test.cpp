// `selftest` as a new user runs it.

#include <gtest/gtest.h>

#include "apps/reports/report.h"
#include "tests/apps/json.h"
#include "tests/apps/program.h"

namespace sf {
namespace {

TEST(SelfTest, ListNamesEveryCaseWithItsAnswer) {
  const Outcome all = run_successfully({"selftest", "--list"}, no_device());
  EXPECT_GT(count_lines(all.out), 40u);
  EXPECT_NE(all.out.find("beams     grazing "), std::string::npos) << all.out;
}

TEST(SelfTest, AFailureIsReportedAndExitsWithOne) {
  const Outcome outcome = run_program({"selftest", "ranges", "failure"});
  EXPECT_EQ(outcome.code, 1) << outcome.out << outcome.err;
  EXPECT_NE(outcome.out.find("FAILED"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("1 of 1 checks failed; first: fails on purpose"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("1 of 2 cases passed on "), std::string::npos) << outcome.out;
  const Outcome json = run_program({"selftest", "failure", "--json"});
  EXPECT_EQ(json.code, 1);
  EXPECT_FALSE(Json(json.out).flag("/sound"));
  EXPECT_EQ(run_program({"selftest", "--list"}, no_device()).out.find("failure "), std::string::npos);
}

/// One case that only passes or fails, one to the bit, one within its tolerance, one that failed, and one that was not
/// run.
TEST(SelfTest, TheReportListsEachResult) {
  using selftest::Case;
  const Case plain{"a", "plain", "", "", nullptr}, bits{"a", "bits", "m", "", nullptr},
      near{"b", "near", "m", "", nullptr};
  apps::SelfTestReport report{.asked = 5, .seconds = 1.5};
  report.device.name = "device";
  report.cases.push_back({&plain, {.checks = 3}});
  report.cases.push_back({&bits, {.checks = 20}});
  report.cases.push_back({&near, {.checks = 4, .error = 0.25, .allowed = 0.5, .notes = {"one", "two"}}});
  EXPECT_FALSE(report.sound()) << "two were not run";
  report.asked = 3;
  EXPECT_TRUE(report.sound());
  report.asked = 5;
  report.cases.push_back({&bits, {.checks = 2, .failed = 1, .error = 0.5, .failure = "x [1]"}});
  EXPECT_FALSE(report.sound());
  EXPECT_EQ(report.passed(), 3u);
  EXPECT_EQ(apps::self_test_text(report),
            "group     case                          checks  closest call: error of limit\n"
            "a         plain                              3  pass or fail                   ok\n"
            "a         bits                              20  0: bitwise equal               ok\n"
            "b         near                               4  0.25 of 0.5 m                  ok\n"
            "          one\n"
            "          two\n"
            "a         bits                               2  0.5 of 0 m                     FAILED\n"
            "          1 of 2 checks failed; first: x [1]\n"
            "3 of 4 cases passed on device: 29 checks in 1.5 s; interrupted, 1 not run\n");
  report.asked = 4;
  EXPECT_TRUE(apps::self_test_text(report).ends_with("29 checks in 1.5 s\n"));
}

TEST(SelfTest, AnEmptyReportIsNotSound) { EXPECT_FALSE(apps::SelfTestReport{}.sound()); }

TEST(SelfTest, ACaseWithoutChecksFails) {
  const selftest::Case idle{"a", "idle", "", "", nullptr};
  apps::SelfTestReport report;
  report.cases.push_back({&idle, {}});
  EXPECT_FALSE(report.sound());
}

TEST(SelfTest, WrongUsageIsRejected) {
  expect_refused({"selftest", "grasing"}, "'grasing' is neither a case nor a group");
  EXPECT_EQ(run_program({"selftest", "--list", "grazing"}).code, 2);
  EXPECT_EQ(run_program({"selftest", "grazing", "--require-vulkan"}, no_device()).code, 3);
  EXPECT_EQ(run_program({"selftest", "grazing", "--device", "no such device"}).code, 3);
}

}  // namespace
}  // namespace sf
