#include "scenarios/runner.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "tests/refusal.h"

namespace sf::scenarios {
namespace {

constexpr const char* kRunFile = SF_SOURCE_DIR "/experiments/test.toml";
constexpr const char* kRooms = "world = \"../worlds/rooms.world\"\n";
constexpr const char* kPath = "world = \"../worlds/testpath/testpath.world\"\n";

/// Returns the error of the check from the file's name on; empty without an error.
std::string run_refusal(const std::string& text) {
  return refusal_from("test.toml", [&] { check_scenario(parse_scenario(kRunFile, text)); });
}

/// One error each, with the message before any run.
TEST(CheckScenario, ErrorsOfARunAreFoundAtTheirLines) {
  const std::string rooms = kRooms, path = kPath;
  const std::string robots = "robots = 2\n";
  const std::pair<std::string, std::string> kCorpus[] = {
      {"# a comment\nworld = \"nowhere.world\"\n", "test.toml:2: there is no world '"},
      {"world = \"..\"\n", "test.toml:1: there is no world '"},
      // Detected only by the controller: it needs a lane edge sensor.
      {rooms + "[default]\nrate = 5\ncontroller = \"lane-keeping\"\n", "test.toml:4: controller 'lane-keeping'"},
      {path + "[[robot]]\nname = \"roomba0\"\ncontroller = \"route\"\n", "test.toml:4: "},
      {path + "[default]\ncontroller = \"lane-keeping\"\nsettings = { kp = \"much\" }\n", "test.toml:4: 'kp'"},
      {path + "[[robot]]\nname = \"roomba7\"\n", "test.toml:2: "},
      {path + "[expect]\nlights_obeyed = true\n", "test.toml:3: "},
      {path + "[default]\ncontroller = \"none\"\n[expect]\nmean_error = 1\n",
       "test.toml:5: 'mean_error' of a robot without a controller"},
      // Nothing would be simulated, and `no_collision` would be met: zero, and less than half of a tick of 0.1 s.
      {rooms + "duration = 0\n", "test.toml:2: 'duration' 0 s is shorter than a tick of 0.1 s"},
      {rooms + "duration = 1e-9\n", "test.toml:2: 'duration' 1e-09 s is shorter than a tick of 0.1 s"},
      {rooms + "duration = 0.049\n", "test.toml:2: 'duration' 0.049 s is shorter than a tick of 0.1 s"},
  };
  for (const auto& [text, message] : kCorpus) EXPECT_EQ(run_refusal(text).substr(0, message.size()), message) << text;
}

TEST(CheckScenario, AValidScenarioPasses) {
  EXPECT_EQ(run_refusal(std::string(kRooms) + "robots = 2\n"), "");
  EXPECT_EQ(run_refusal(std::string(kRooms) + "duration = 0.1\n"), "") << "a single tick";
  EXPECT_EQ(run_refusal(std::string(kPath) + "[default]\ncontroller = \"lane-keeping\"\n[expect]\nmean_error = 1\n"),
            "");
}

/// A caller that does not check first gets the same errors, and no run.
TEST(RunScenario, RejectsTheSameFilesAsTheCheck) {
  gpu::Device device;
  for (const std::string& text :
       {std::string(kPath) + "[expect]\nlights_obeyed = true\n",
        std::string(kPath) + "duration = 1\n[default]\ncontroller = \"none\"\n[expect]\nmean_error = 1\n",
        std::string(kPath) + "[default]\ncontroller = \"lane-keeping\"\nsettings = { kp = \"much\" }\n"}) {
    const std::string refusal = run_refusal(text);
    ASSERT_FALSE(refusal.empty()) << text;
    expect_in(refusal, refusal_of([&] { run_scenario(parse_scenario(kRunFile, text), device); }));
  }
}

TEST(ScenarioStatus, NoExpectationsNeitherPassNorFail) {
  ScenarioResult result;
  EXPECT_EQ(result.status(), ScenarioStatus::no_expectations);
  result.outcomes.push_back({.met = true});
  EXPECT_EQ(result.status(), ScenarioStatus::passed);
  result.outcomes.push_back({.met = false});
  EXPECT_EQ(result.status(), ScenarioStatus::failed);
}

}  // namespace
}  // namespace sf::scenarios
