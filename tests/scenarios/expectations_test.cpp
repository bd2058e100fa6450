#include "scenarios/expectations.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "scenarios/runner.h"

namespace sf::scenarios {
namespace {

constexpr const char* kExpectationFile = SF_SOURCE_DIR "/experiments/test.toml";
constexpr const char* kExpectationRooms = "world = \"../worlds/rooms.world\"\n";

/// A wandering robot has no control error: the result states this and is a failure.
TEST(Expectations, ReportMetricsThatCannotBeMeasured) {
  gpu::Device device;
  const ScenarioResult result =
      run_scenario(parse_scenario(kExpectationFile, std::string(kExpectationRooms) +
                                                        "robots = 2\nduration = 1\n[expect]\nmean_abs_error = 1\n"),
                   device);
  ASSERT_EQ(result.outcomes.size(), 1u);
  EXPECT_FALSE(result.outcomes[0].met);
  EXPECT_EQ(result.outcomes[0].measured, "no robot with a control error");
}

/// The smallest distance of several robots counts: the second one is at rest.
TEST(Expectations, DistanceIsTheMinimumOverRobots) {
  gpu::Device device;
  const ScenarioResult result = run_scenario(
      parse_scenario(kExpectationFile, std::string(kExpectationRooms) +
                                           "duration = 1\n[[robot]]\nname = \"roomba2\"\ncontroller = \"none\"\n"
                                           "[expect]\ndistance = 0.01\n"),
      device);
  ASSERT_EQ(result.outcomes.size(), 1u);
  EXPECT_EQ(result.outcomes[0].measured, "0");
  EXPECT_FALSE(result.outcomes[0].met);
}

/// The worst of several robots counts, one that starts next to its lane. Errors of both signs count, although they
/// would cancel in a mean.
TEST(Expectations, TheControlErrorIsThatOfTheWorstRobot) {
  const std::string world = testing::TempDir() + fmt::format("two_in_a_lane_{}.world", getpid());
  std::ofstream(world) << "include \"" SF_SOURCE_DIR "/worlds/testpath/testpath.world\"\n"
                       << "create( name \"offset\" pose [1.0 0.06 0 0] create_laneedge( name \"laneedge\" ) )\n";
  gpu::Device device;
  const auto measured = [&](const std::string& what) {
    const ScenarioResult result = run_scenario(
        parse_scenario(kExpectationFile, "world = \"" + world +
                                             "\"\nduration = 10\n[default]\ncontroller = \"lane-keeping\"\n"
                                             "settings = { kp = 3.0, speed = 0.1 }\n[expect]\n" +
                                             what + "\n"),
        device);
    return std::stod(result.outcomes.at(0).measured);
  };
  const double ahead = measured("mean_abs_error = { roomba0 = 1 }");
  const double offset = measured("mean_abs_error = { offset = 1 }");
  EXPECT_LT(ahead, 0.5 * offset);
  EXPECT_GT(offset, 1e-3);
  EXPECT_EQ(measured("mean_abs_error = 1"), offset);
  EXPECT_LT(measured("mean_error = { offset = 1 }"), offset) << "it swings to both sides";
  std::filesystem::remove(world);
}

/// With one missed cell of 9000, coverage is not complete.
TEST(Expectations, MapCoverageIsNotRoundedUp) {
  gpu::Device device;
  const ScenarioResult result =
      run_scenario(parse_scenario(kExpectationFile,
                                  "world = \"../worlds/mapping/mapping.world\"\nduration = 1\n[default]\n"
                                  "controller = \"none\"\n[expect]\nmap_coverage = 0.9\n"),
                   device);
  ASSERT_EQ(result.outcomes.size(), 1u);
  const double measured = std::stod(result.outcomes[0].measured);
  EXPECT_GT(measured, 0.0);
  EXPECT_LT(measured, 0.2) << "one scan";
  EXPECT_FALSE(result.outcomes[0].met);
}

}  // namespace
}  // namespace sf::scenarios
