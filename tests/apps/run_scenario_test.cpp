// `run` with a scenario file instead of a world.

#include <gtest/gtest.h>

#include "base/hash.h"
#include "scenarios/runner.h"
#include "tests/apps/json.h"
#include "tests/apps/program.h"
#include "tests/device.h"

namespace sf {
namespace {

const std::string kTown = SF_SOURCE_DIR "/experiments/simville.toml";

// Two robots in a room, and a door that is removed after a second.
const char* const kDoorRoom = R"(
model( size [0.1 4 1] pose [2 0 0 0] )
model( size [0.1 4 1] pose [-2 0 0 0] )
model( name "tag1" size [0.1 1 1] pose [0.5 0 0 0] )
define robot position( size [0.3 0.3 0.3] laser( samples 9 fov 90 range_max 5 ) )
robot( name "a" pose [-1 0 0 0] )
robot( name "b" pose [-1 1 0 0] )
)";
const std::string kDoorScenario = R"(
world = "room.world"
duration = 2
seed = 7
[default]
controller = "none"
[[robot]]
name = "b"
controller = "wander"
settings = { speed = 0.2 }
)";
const std::string kDoor = R"([[event]]
at = 1
object = "tag1"
present = false
)";

TEST(RunScenario, TheTownOfTheReadmeDrivesAMinuteWithoutContact) {
  const Json facts = run_json({"run", kTown, "--duration", "60", "--json"});
  EXPECT_EQ(facts.number("/contacts"), 0);
  EXPECT_EQ(facts.number("/robots"), 50);
}

// Fleet, controllers, seed, duration and events are those of `test`, and so are all readings.
TEST(RunScenario, GivesTheSameReadingsAsTest) {
  const Folder folder;
  folder.write("room.world", kDoorRoom);
  const std::string file = folder.write("door.toml", kDoorScenario + kDoor);
  const std::string without = folder.write("wall.toml", kDoorScenario);
  const Json facts = run_json({"run", file, "--json"});
  const scenarios::ScenarioResult tested = scenarios::run_scenario(scenarios::read_scenario(file), device());
  EXPECT_EQ(facts.text("/hash"), base::hash_hex(tested.hash));
  EXPECT_EQ(facts.number("/ticks"), static_cast<double>(tested.ticks));
  EXPECT_NE(facts.text("/hash"), run_json({"run", without, "--json"}).text("/hash")) << "the door stays";
}

// Robots that join and leave are recorded, verified and drawn; all readings are those of `test`.
TEST(RunScenario, RobotsJoinAndLeave) {
  const Folder folder;
  folder.write("room.world", kDoorRoom);
  const std::string file = folder.write("join.toml", kDoorScenario + R"([[event]]
at = 0.5
add = "c"
like = "a"
pose = [-1, -1, 0]
controller = "wander"
[[event]]
at = 1.5
remove = "b"
)");
  const scenarios::ScenarioResult tested = scenarios::run_scenario(scenarios::read_scenario(file), device());
  const Json facts = run_json({"run", file, "--json", "--record", folder.path("r"), "--record-readings"});
  EXPECT_EQ(facts.text("/hash"), base::hash_hex(tested.hash));
  EXPECT_EQ(facts.number("/robots"), 3);
  EXPECT_EQ(run_program({"verify", folder.path("r")}).code, 0);
  const std::string frames = folder.path("frames");
  EXPECT_EQ(run_program({"run", file, "--video", folder.path("run.webm")}).code, 0);
  EXPECT_EQ(run_program({"view", folder.path("r"), "--frames", frames}).code, 0);
}

// Faulty readings are counted in both reports, recorded, and verified with their faults.
TEST(RunScenario, SensorsHaveFaults) {
  const Folder folder;
  folder.write("room.world", kDoorRoom);
  const std::string bias = "[[fault]]\nrobot = \"*\"\nsensor = \"laser\"\nkind = \"bias\"\noffset = 0.1\nuntil = 1\n";
  const std::string lost = "[[fault]]\nrobot = \"a\"\nsensor = \"laser\"\nkind = \"dropout\"\nfrom = 1.45\n";
  const std::string file = folder.write("faults.toml", kDoorScenario + bias + lost);
  const Json facts = run_json({"run", file, "--json", "--record", folder.path("r"), "--record-readings"});
  EXPECT_EQ(facts.number("/faults/bias"), 20);
  EXPECT_EQ(facts.number("/faults/dropout"), 5);
  EXPECT_NE(run_successfully({"run", file}).out.find("bias 20, dropout 5"), std::string::npos);
  const Outcome verified = run_successfully({"verify", folder.path("r")});
  EXPECT_NE(verified.out.find("20 faulty scans in plain C++"), std::string::npos) << verified.out;
  const std::string wrong =
      folder.write("wrong.toml", kDoorScenario + "[[fault]]\nrobot = \"c\"\nsensor = \"laser\"\nkind = \"stuck\"\n");
  expect_refused({"run", wrong}, "wrong.toml:11: no robot is called 'c'");
}

TEST(RunScenario, RejectsOptionsThatTheScenarioDefines) {
  for (const Words& option : {Words{"--robots", "3"}, Words{"--robots", "3", "--of", "roomba0"}, Words{"--seed", "2"},
                              Words{"--seed", "1"}, Words{"--controller", "wander"}, Words{"--controller", "avoid"},
                              Words{"--set", "speed=0.1"}, Words{"--localize"}, Words{"--drive", "roomba0"}}) {
    expect_refused(with({"run", kTown, "--duration", "1"}, option), "applies to worlds; a scenario sets");
  }
}

TEST(RunScenario, ReportsThatExpectationsAreNotChecked) {
  const Outcome outcome = run_successfully({"run", kTown, "--duration", "1"});
  EXPECT_NE(outcome.err.find("9 expectations are not checked"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace sf
