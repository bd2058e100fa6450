// Events that change the use of lanes.

#include <gtest/gtest.h>

#include "scenarios/runner.h"
#include "tests/device.h"
#include "tests/refusal.h"

namespace sf::scenarios {
namespace {

const std::string kLaneTown = R"(world = "../worlds/simville/simville.world"
duration = 100
robots = 6
of = "roomba4"
place = "lanes"
[default]
controller = "route"
settings = { localize = false, tour = true }
[expect]
no_collision = true
lights_obeyed = true
all_checkpoints = 2
)";

Scenario with_events(const std::string& events) {
  return parse_scenario(SF_SOURCE_DIR "/experiments/test.toml", kLaneTown + events);
}

/// Six robots tour the town, again with the same result, and with another one than without the events.
TEST(LaneEvent, RobotsReplanWithoutContacts) {
  const std::string events =
      "[[event]]\nat = 10\nlane = \"1.1\"\nuse = \"reversed\"\n"
      "[[event]]\nat = 20\nlane = \"3.1\"\nuse = \"closed\"\n"
      "[[event]]\nat = 60\nlane = \"1.1\"\nuse = \"open\"\n";
  const ScenarioResult one = run_scenario(with_events(events), device());
  const ScenarioResult two = run_scenario(with_events(events), device());
  const ScenarioResult without = run_scenario(with_events(""), device());
  EXPECT_EQ(one.status(), ScenarioStatus::passed) << one.failure;
  EXPECT_EQ(one.hash, two.hash);
  EXPECT_NE(one.hash, without.hash);
}

TEST(LaneEvent, ErrorsNameLineAndRemedy) {
  const auto refusal = [](const std::string& event) {
    return refusal_from("test.toml", [&] { check_scenario(with_events("[[event]]\n" + event)); });
  };
  EXPECT_EQ(refusal("at = 1\nlane = \"3.1\"\nuse = \"closed\"\n"), "");
  const std::pair<std::string, std::string> kCorpus[] = {
      {"at = 1\nlane = \"3.1\"\n", "test.toml:13: 'use' is missing; an event has at = SECONDS, lane"},
      {"at = 1\nlane = \"3.9\"\nuse = \"closed\"\n", "test.toml:13: "},
      {"at = 1\nlane = \"3.1\"\nuse = \"close\"\n",
       "test.toml:13: no use of a lane is 'close'; did you mean 'closed'?"},
      {"at = 1\nlane = \"3.1\"\nuse = \"right\"\n", "test.toml:13: "},
      {"at = 1\nlane = \"3.1\"\npresent = true\n", "test.toml:16: unknown key 'present'"},
  };
  for (const auto& [text, message] : kCorpus) EXPECT_EQ(refusal(text).substr(0, message.size()), message) << text;
}

}  // namespace
}  // namespace sf::scenarios
