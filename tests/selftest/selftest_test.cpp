// All cases of `sensorfarm selftest`, and a failing one.

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <functional>
#include <ostream>
#include <set>

#include "base/error.h"
#include "base/thread_pool.h"
#include "selftest/suite.h"
#include "tests/golden.h"
#include "tests/instrumented.h"

namespace sf::selftest {

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

namespace {

Fixture& all_fixture() {
  static gpu::Device device;
  static Fixture all_fixture(device);
  return all_fixture;
}

std::string test_name(const testing::TestParamInfo<Case>& info) {
  std::string name(info.param.name);
  std::erase_if(name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; });
  return name;
}

/// Finds `text` in a golden record.
void expect_recorded(const std::string& name, const std::string& text) {
  if (const char* const path = std::getenv("SENSORFARM_RECORDS"))
    std::ofstream(fmt::format("{}/{}.txt", path, name), std::ios::app) << text;
  if (instrumented()) return;
  const std::string file = fmt::format("tests/selftest/golden/{}.txt", name);
  const std::string record = golden::read(SF_SOURCE_DIR "/" + file);
  EXPECT_NE(("\n" + record).find("\n" + text), std::string::npos) << file << " has no\n" << text;
}

/// Checks, the check closest to its tolerance, and notes: reveals a changed tolerance even if the case passes.
std::string judged(const Case& c, const Outcome& o) {
  std::string text = fmt::format("{} {}: {:.2g} of {:.3g}\n", c.name, o.checks, o.error, o.allowed);
  for (const std::string& note : o.notes) text += "  " + note + "\n";
  return text;
}

class Extremes : public testing::TestWithParam<Case> {};

TEST_P(Extremes, AllCasesPass) {
  const Outcome o = run(GetParam(), all_fixture());
  std::printf("[ measured ] %s: %llu checks, closest call %.3g of %.3g allowed, %.2f s\n",
              std::string(GetParam().name).c_str(), static_cast<unsigned long long>(o.checks), o.error, o.allowed,
              o.seconds);
  for (const std::string& note : o.notes) std::printf("[ measured ]   %s\n", note.c_str());
  EXPECT_TRUE(o.passed()) << o.failed << " of " << o.checks << " checks: " << o.failure;
  expect_recorded("cases", judged(GetParam(), o));
}

INSTANTIATE_TEST_SUITE_P(All, Extremes, testing::ValuesIn(cases().begin(), cases().end()), test_name);

TEST(Suite, NamesAreUniqueAndReasonsAreGiven) {
  std::set<std::string_view> names;
  for (const Case& c : cases()) {
    EXPECT_TRUE(names.insert(c.name).second) << c.name;
    EXPECT_FALSE(c.why.empty()) << c.name;
  }
  EXPECT_GT(names.size(), 40u);
}

Outcome outcome_of(void (*body)(Fixture&, Checks&)) { return run({"made", "made", "m", "made", body}, all_fixture()); }

Outcome outcome_of(const std::function<void(Checks&)>& body) {
  Checks checks;
  body(checks);
  return checks.outcome();
}

/// A wrong result is reported with the failed check and its error.
TEST(Suite, AWrongAnswerFails) {
  const Outcome o = outcome_of([](Fixture& l, Checks& checks) {
    world::World world;
    add_wall(world, {2.0, -1.0}, {2.0, 1.0});
    add_laser_mover(world, {}, laser(1, 0.0, 8.0));
    const TestFarm test = l.measure(world);
    checks.near(test.readings[0].values[0], 2.0, 1e-9, "right");
    checks.near(test.readings[0].values[0], 2.5, 1e-9, "wrong", 7);
  });
  EXPECT_FALSE(o.passed());
  EXPECT_EQ(o.checks, 2u);
  EXPECT_EQ(o.failed, 1u);
  EXPECT_EQ(o.error, 0.5);
  EXPECT_NE(o.failure.find("wrong [7]: 2, expected 2.5 within 1e-09"), std::string::npos) << o.failure;
}

TEST(Suite, EveryKindOfCheckCanFail) {
  EXPECT_FALSE(outcome_of([](Fixture&, Checks& c) { c.near(kNan, 0, 1e300, "not a number"); }).passed());
  EXPECT_FALSE(outcome_of([](Fixture&, Checks& c) { c.near(1, kNan, 1e300, "not a number"); }).passed());
  EXPECT_FALSE(outcome_of([](Fixture&, Checks& c) { c.same(0.0, -0.0, "another bit"); }).passed());
  EXPECT_FALSE(outcome_of([](Fixture&, Checks& c) { c.equal(-1, 0xFFFFFFFFu, "signs"); }).passed());
  EXPECT_FALSE(outcome_of([](Fixture&, Checks& c) { c.holds(false, "false"); }).passed());
  EXPECT_FALSE(outcome_of([](Fixture&, Checks& c) { c.refused([] {}, "", "taken"); }).passed());
  EXPECT_FALSE(
      outcome_of([](Fixture&, Checks& c) { c.refused([] { throw base::InputError("y"); }, "x", "y"); }).passed());
  EXPECT_FALSE(outcome_of([](Fixture&, Checks&) { throw base::InputError("thrown"); }).passed());
  EXPECT_FALSE(outcome_of([](Fixture&, Checks&) {}).passed()) << "a case without checks";
  EXPECT_TRUE(outcome_of([](Fixture&, Checks& c) { c.same(kNan, -kNan, "neither is a number"); }).passed());
}

/// Errors of 0.25 and of the next larger double: sums with 0 and 1 are exact.
TEST(Suite, AnErrorEqualToItsToleranceStillPasses) {
  for (const double sign : {1.0, -1.0})
    for (const double exact : {0.0, 1.0}) {
      const double last = exact + sign * 0.25, beyond = std::nextafter(last, sign * HUGE_VAL);
      EXPECT_TRUE(outcome_of([&](Checks& c) { c.near(last, exact, 0.25, "last"); }).passed()) << last;
      EXPECT_FALSE(outcome_of([&](Checks& c) { c.near(beyond, exact, 0.25, "beyond"); }).passed()) << last;
    }
  EXPECT_TRUE(outcome_of([](Checks& c) { c.near(2, 2, 0, "equal"); }).passed());
  EXPECT_FALSE(outcome_of([](Checks& c) { c.near(1, 1 + 1e-19L, 0, "less than a double's bit"); }).passed());
  EXPECT_FALSE(outcome_of([](Checks& c) { c.near(1, 1, kNan, "no tolerance"); }).passed());
  EXPECT_FALSE(outcome_of([](Checks& c) { c.near(kInfinity, 1, 1e300, "infinite"); }).passed());
}

TEST(Suite, SameComparesBitwise) {
  const double next = std::nextafter(1.0, 2.0);
  EXPECT_TRUE(outcome_of([](Checks& c) { c.same(kInfinity, kInfinity, "infinite"); }).passed());
  EXPECT_FALSE(outcome_of([&](Checks& c) { c.same(next, 1.0, "a bit more"); }).passed());
  EXPECT_FALSE(outcome_of([](Checks& c) { c.same(kNan, 1.0, "no number"); }).passed());
  EXPECT_FALSE(outcome_of([](Checks& c) { c.same(1.0, kNan, "a number"); }).passed());
  EXPECT_FALSE(outcome_of([](Checks& c) { c.same(kInfinity, -kInfinity, "sign"); }).passed());
}

TEST(Suite, EveryKindOfCheckNamesItsFailure) {
  const auto failure = [](const std::function<void(Checks&)>& body) { return outcome_of(body).failure; };
  EXPECT_EQ(failure([](Checks& c) { c.near(kNan, 1, 0.5, "near", 3); }), "near [3]: nan, expected 1 within 0.5");
  EXPECT_EQ(failure([](Checks& c) { c.same(0.1, 0.25, "same", 4); }), "same [4]: 0.10000000000000001, expected 0.25");
  EXPECT_EQ(failure([](Checks& c) { c.equal(6, 7u, "count", 5); }), "count: 6, expected 7 [5]");
  EXPECT_EQ(failure([](Checks& c) { c.holds(false, "holds", 6); }), "holds [6]");
  EXPECT_EQ(failure([](Checks& c) { c.refused([] {}, "word", "call"); }),
            "call: expected a rejection that names 'word', got: was accepted [0]");
  EXPECT_EQ(failure([](Checks& c) { c.refused([] { throw base::InputError("y"); }, "x", "call"); }),
            "call: expected a rejection that names 'x', got: y [0]");
  EXPECT_EQ(outcome_of([](Fixture&, Checks&) { throw base::InputError("thrown"); }).failure,
            "it ended with: thrown [0]");
}

/// Each case polls for a stop at each of its checks.
TEST(Suite, AStopEndsEachCase) {
  const Fixture& all = all_fixture();
  Fixture stopped(all.device(), [] { return true; });
  for (const Case& c : cases()) EXPECT_THROW(run(c, stopped), base::Interrupted) << c.name;
}

TEST(Suite, RefusalsOfInputsAndDevicesPass) {
  const Outcome o = outcome_of([](Checks& c) {
    c.refused([] { throw base::InputError("bad word"); }, "word", "input");
    c.refused([] { throw base::DeviceError("bad word"); }, "word", "device");
  });
  EXPECT_TRUE(o.passed()) << o.failure;
  EXPECT_EQ(o.checks, 2u);
}

TEST(Suite, EveryFailureCountsAndTheFirstIsReported) {
  const Outcome o = outcome_of([](Checks& c) {
    c.holds(true, "good");
    c.near(2, 1, 0.5, "first");
    c.same(2, 1, "second");
    c.holds(false, "third");
    c.equal(2, 1, "fourth");
  });
  EXPECT_EQ(o.checks, 5u);
  EXPECT_EQ(o.failed, 4u);
  EXPECT_EQ(o.failure, "first [0]: 2, expected 1 within 0.5");
}

TEST(Suite, NotesAreKeptUpToTwelve) {
  const Outcome o = outcome_of([](Checks& c) {
    for (int i = 0; i < 14; ++i) c.note(std::to_string(i));
  });
  ASSERT_EQ(o.notes.size(), 12u);
  EXPECT_EQ(o.notes.front(), "0");
  EXPECT_EQ(o.notes.back(), "11");
}

/// An error that is NaN, or that has no tolerance, exceeds all others.
TEST(Suite, IncomparableErrorsAreReportedAsClosest) {
  for (const double got : {kNan, kInfinity}) {
    const Outcome o = outcome_of([&](Checks& c) {
      c.near(got, 0, 2.0, "beyond");
      c.near(100, 0, 1.0, "a hundred times");
    });
    EXPECT_EQ(o.error, kInfinity);
    EXPECT_EQ(o.allowed, 2.0);
  }
  const Outcome o = outcome_of([](Checks& c) {
    c.near(100, 0, 1.0, "a hundred times");
    c.same(3, 1, "to the bit");
  });
  EXPECT_EQ(o.error, 2.0);
  EXPECT_EQ(o.allowed, 0.0);
}

TEST(Suite, TheCheckClosestToItsToleranceIsReported) {
  const Outcome o = outcome_of([](Fixture&, Checks& c) {
    c.near(1.0 + 1e-3, 1, 1e-2, "a tenth");
    c.near(1.0 + 1e-6, 1, 2e-6, "a half");
    c.same(1.0, 1.0, "nothing");
  });
  EXPECT_TRUE(o.passed());
  EXPECT_NEAR(o.error, 1e-6, 1e-12);
  EXPECT_EQ(o.allowed, 2e-6);
}

/// A non-finite pose is a programming error: packets and files are validated before.
TEST(SuiteDeathTest, ANonFinitePoseAborts) {
  world::World world;
  add_laser_mover(world, {}, laser(1, 0.0, 8.0));
  const TestFarm test = all_fixture().measure(world);
  const base::Report report{.mover = 0, .X_WM = {std::numeric_limits<double>::quiet_NaN(), 0, 0, 0}};
  EXPECT_DEATH(test.farm->tick(1, {&report, 1}), "the pose of mover 0 is not finite");
}

}  // namespace
}  // namespace sf::selftest
