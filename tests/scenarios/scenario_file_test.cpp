#include <gtest/gtest.h>

#include <filesystem>

#include "base/error.h"
#include "scenarios/scenario.h"
#include "tests/refusal.h"

namespace sf::scenarios {
namespace {

constexpr const char* kFile = SF_SOURCE_DIR "/experiments/test.toml";
constexpr const char* kWorld = "world = \"../worlds/testpath/testpath.world\"\n";

Scenario parse_text(const std::string& text) { return parse_scenario(kFile, kWorld + text); }

/// Returns the error from the file's name on; empty without an error.
std::string refusal(const std::string& text, bool make = false) {
  return refusal_from("test.toml", [&] {
    const Scenario scenario = parse_scenario(kFile, text);
    if (make) simulation_of(scenario, world_of(scenario));
  });
}

TEST(ScenarioFile, DefaultsOfAFileWithOnlyAWorld) {
  const Scenario s = parse_text("");
  EXPECT_EQ(s.name, "test");
  EXPECT_TRUE(std::filesystem::exists(s.world)) << s.world;
  EXPECT_EQ(s.duration, 60.0);
  EXPECT_EQ(s.seed, 1u);
  EXPECT_EQ(s.actor.controller.name, "wander");
  EXPECT_TRUE(s.actor.link.perfect());
  EXPECT_FALSE(s.plant);
  EXPECT_TRUE(s.expect.empty());
}

TEST(ScenarioFile, EveryKeyIsRead) {
  const Scenario s = parse_text(R"(
name = "all keys"
duration = 12.5
seed = 77
tick = 0.05
robots = 3
of = "roomba0"
place = "lanes"
plant = "thesis"
start_at = 2
[default]
controller = "wander"
rate = 5
[link]
delay = 0.1
jitter = 0.2
loss = 0.3
[[robot]]
name = "roomba0"
controller = "none"
pose = [1, 2, 90]
link = { delay = 1 }
[expect]
no_collision = true
contacts = 4
mean_error = 0.01
mean_abs_error = { roomba0 = 0.5 }
map_coverage = 0.9
lights_obeyed = true
done = true
distance = 3.5
checkpoints = 2
all_checkpoints = 9
tick_p99_ms = 10
)");
  EXPECT_EQ(s.name, "all keys");
  EXPECT_EQ(s.duration, 12.5);
  EXPECT_EQ(s.seed, 77u);
  EXPECT_EQ(s.tick, 0.05);
  EXPECT_EQ(s.fleet.robots, 3u);
  EXPECT_EQ(s.fleet.of, "roomba0");
  EXPECT_EQ(s.fleet.place, FleetSpawn::Placement::lanes);
  EXPECT_EQ(s.plant, Plant::thesis);
  EXPECT_EQ(s.start_at, 2.0);
  EXPECT_EQ(s.actor.controller.rate, 5.0);
  EXPECT_EQ(s.actor.link.jitter, 0.2);
  ASSERT_EQ(s.robot_setups.size(), 1u);
  EXPECT_EQ(s.robot_setups[0].actor->controller.name, "");
  EXPECT_EQ(s.robot_setups[0].actor->link.delay, 1.0);
  EXPECT_EQ(s.robot_setups[0].actor->link.loss, 0.0);
  EXPECT_NEAR(s.robot_setups[0].pose->yaw, M_PI / 2, 1e-15);
  ASSERT_EQ(s.expect.size(), 11u);
  for (const Expectation& e : s.expect)
    EXPECT_EQ(e.robot, e.kind == Expectation::Kind::mean_abs_error ? "roomba0" : "");
}

/// A robot with only settings keeps the default's controller; one with another controller starts without settings.
TEST(ScenarioFile, RobotsInheritUnsetKeys) {
  const Scenario s = parse_text(R"(
[default]
controller = "lane-keeping"
rate = 20
settings = { kp = 0.7 }
[[robot]]
name = "roomba0"
settings = { kp = 0.9 }
)");
  ASSERT_EQ(s.robot_setups.size(), 1u);
  control::ControllerConfig config = s.robot_setups[0].actor->controller;
  EXPECT_EQ(config.name, "lane-keeping");
  EXPECT_EQ(config.rate, 20.0);
  EXPECT_EQ(config.settings.number("kp", 0.0, 0.0, 10.0), 0.9);
}

TEST(ScenarioFile, RobotsWithOnlyAPoseKeepTheDefault) {
  const Scenario s = parse_text("[[robot]]\nname = \"roomba0\"\npose = [1, 0.1, 5]\n");
  ASSERT_EQ(s.robot_setups.size(), 1u);
  EXPECT_FALSE(s.robot_setups[0].actor);
  const world::World world = world_of(s);
  EXPECT_EQ(world.movers[0].X_WM.x, 1.0);
  EXPECT_NE(world.hash, world_of(parse_text("")).hash);
}

TEST(ScenarioFile, ThePlantSetsTheActuatorModelOfEveryMover) {
  EXPECT_EQ(world_of(parse_text("")).movers[0].actuator_model, world::ActuatorModel::direct);
  EXPECT_EQ(world_of(parse_text("plant = \"thesis\"")).movers[0].actuator_model, world::ActuatorModel::player_create);
  EXPECT_EQ(world_of(parse_text("plant = \"ideal\"")).movers[0].actuator_model, world::ActuatorModel::direct);
  Scenario cars = parse_scenario(kFile, "world = \"../worlds/vesim/vesim.world\"\nplant = \"thesis\"\n");
  expect_in("has 'dynamics'; expected \"ideal\"", refusal_of([&] { world_of(cars); }));
  cars.plant = Plant::ideal;
  EXPECT_NO_THROW(world_of(cars));
}

TEST(ScenarioFile, LinksHaveTheScenariosSeed) {
  const Scenario s = parse_text("seed = 9\n[link]\ndelay = 0.5\n");
  EXPECT_EQ(simulation_of(s, world_of(s)).actors[0].link.seed, 9u);
}

TEST(ScenarioFile, StatesHaveALinkIfConfigured) {
  EXPECT_FALSE(parse_text("").states);
  const Scenario s = parse_text(
      "seed = 9\n[states]\nrate = 5\ndelay = 0.5\njitter = 0.1\nloss = 0.2\nfilter = true\nposition_sigma = "
      "0.01\nyaw_sigma = 0.02\n");
  const StateLinkOptions states = *simulation_of(s, world_of(s)).states;
  EXPECT_EQ(states.rate, 5.0);
  EXPECT_EQ(states.link.delay, 0.5);
  EXPECT_EQ(states.link.jitter, 0.1);
  EXPECT_EQ(states.link.loss, 0.2);
  EXPECT_EQ(states.link.seed, 9u);
  EXPECT_TRUE(states.filter);
  EXPECT_EQ(states.position_sigma, 0.01);
  EXPECT_EQ(states.yaw_sigma, 0.02);
  EXPECT_FALSE(parse_text("[states]\n").states->filter);
}

TEST(ScenarioFile, V2vHasALinkIfConfigured) {
  EXPECT_FALSE(parse_text("").v2v);
  const Scenario s = parse_text("seed = 9\n[v2v]\nrate = 5\ndelay = 0.5\njitter = 0.1\nloss = 0.2\nforget = 2\n");
  const V2vLinkOptions v2v = *simulation_of(s, world_of(s)).v2v;
  EXPECT_EQ(v2v.rate, 5.0);
  EXPECT_EQ(v2v.forget, 2.0);
  EXPECT_EQ(v2v.link.delay, 0.5);
  EXPECT_EQ(v2v.link.jitter, 0.1);
  EXPECT_EQ(v2v.link.loss, 0.2);
  EXPECT_EQ(v2v.link.seed, 9u);
}

TEST(ScenarioFile, PositioningHasALinkNoiseAndOutagesIfConfigured) {
  EXPECT_FALSE(parse_text("").positioning);
  const Scenario s = parse_text(
      "seed = 9\n[positioning]\nrate = 5\ndelay = 0.5\nposition_sigma = 0.01\nyaw_sigma = 0.02\n"
      "stated_position_sigma = 0.03\nstated_yaw_sigma = 0.04\noutages = [[1, 2], [3, 3]]\n");
  const PositioningOptions positioning = *simulation_of(s, world_of(s)).positioning;
  EXPECT_TRUE(positioning.known_start);
  EXPECT_FALSE(parse_text("[positioning]\nstart = \"unknown\"\n").positioning->known_start);
  EXPECT_EQ(positioning.rate, 5.0);
  EXPECT_EQ(positioning.link.delay, 0.5);
  EXPECT_EQ(positioning.link.seed, 9u);
  EXPECT_EQ(positioning.position_sigma, 0.01);
  EXPECT_EQ(positioning.yaw_sigma, 0.02);
  EXPECT_EQ(positioning.stated_position_sigma, 0.03);
  EXPECT_EQ(positioning.stated_yaw_sigma, 0.04);
  ASSERT_EQ(positioning.outages.size(), 2u);
  EXPECT_EQ(positioning.outages[0].begin, 1.0);
  EXPECT_EQ(positioning.outages[0].end, 2.0);
}

/// One mistake each, with its message.
TEST(ScenarioFile, MistakesAreRejectedAtTheirLine) {
  const std::string w = kWorld;
  const std::pair<std::string, std::string> kCorpus[] = {
      {"", "test.toml: has no world; expected world = \"FILE\""},
      {"world = 3\n", "test.toml:1: 'world' expects a text in quotes"},
      {"world = \n", "test.toml:1: not TOML"},
      {w + "duraton = 3\n", "test.toml:2: unknown key 'duraton'; did you mean 'duration'?"},
      {w + "duration = -1\n", "test.toml:2: 'duration' expects a number from 0"},
      {w + "duration = nan\n", "test.toml:2: 'duration' expects a number"},
      {w + "duration = \"long\"\n", "test.toml:2: 'duration' expects a number"},
      {w + "seed = 1.5\n", "test.toml:2: 'seed' expects a whole number"},
      {w + "seed = -1\n", "test.toml:2: 'seed' expects a whole number"},
      {w + "tick = 0\n", "test.toml:2: 'tick' expects a number from 0.001"},
      {w + "robots = 70000\n", "test.toml:2: 'robots' expects a whole number from 0 to 65535"},
      {w + "plant = \"real\"\n", "test.toml:2: 'plant' expects \"thesis\" or \"ideal\""},
      {w + "plant = 1\n", "test.toml:2: 'plant' expects \"thesis\" or \"ideal\""},
      {w + "link = 3\n", "test.toml:2: 'link' expects a table"},
      {w + "[link]\nloss = 1.1\n", "test.toml:3: 'loss' expects a number from 0 to 1"},
      {w + "[link]\nlag = 1\n", "test.toml:3: unknown key 'lag'"},
      {w + "[states]\nfilter = 1\n", "test.toml:3: 'filter' expects true or false"},
      {w + "[states]\nrate = 0\n", "test.toml:3: 'rate' expects a number from 0.01"},
      {w + "[v2v]\nlag = 1\n", "test.toml:3: unknown key 'lag'"},
      {w + "[states]\nlag = 1\n", "test.toml:3: unknown key 'lag'"},
      {w + "[positioning]\nlag = 1\n", "test.toml:3: unknown key 'lag'"},
      {w + "[positioning]\noutages = 3\n", "test.toml:3: 'outages' expects a list of intervals"},
      {w + "[positioning]\noutages = [[1]]\n", "test.toml:3: 'outages' expects a list of intervals"},
      {w + "[positioning]\noutages = [[2, 1]]\n", "test.toml:3: 'outages' expects a number from 2"},
      {w + "[default]\ncontroller = \"wandr\"\n",
       "test.toml:3: there is no controller 'wandr'; did you mean 'wander'?"},
      {w + "[default]\nrate = 0\n", "test.toml:3: 'rate' expects a number from 0.01"},
      {w + "[default]\npose = [0, 0, 0]\n", "test.toml:3: unknown key 'pose'"},
      {w + "[default]\nsettings = 3\n", "test.toml:3: 'settings' expects a table"},
      {w + "[default.settings]\na = [1, \"b\"]\n", "test.toml:3: 'a' expects true, false, a number"},
      {w + "[default.settings]\na = 2026-01-01\n", "test.toml:3: 'a' expects true, false, a number"},
      {w + "robot = 3\n", "test.toml:2: 'robot' expects [[robot]] tables"},
      {w + "robot = [3]\n", "test.toml:2: 'robot' expects [[robot]] tables"},
      {w + "[[robot]]\ncontroller = \"none\"\n", "test.toml:2: a robot without a name"},
      {w + "[[robot]]\nname = \"a\"\npose = [1, 2]\n", "test.toml:4: 'pose' expects [x, y, yaw]"},
      {w + "[[event]]\nat = 1\nadd = \"a\"\nlike = \"b\"\npose = [1, 2, 3, 4]\n",
       "test.toml:6: 'pose' expects [x, y, yaw] in metres"},
      {w + "[[robot]]\nname = \"a\"\npose = [1, 2, inf]\n", "test.toml:4: 'pose' expects a number"},
      {w + "[[robot]]\nname = \"a\"\n[[robot]]\nname = \"b\"\n[[robot]]\nname = \"a\"\n",
       "test.toml:6: the robot 'a' is already configured at line 2; expected one [[robot]] per robot"},
      {w + "[expect]\nno_collisions = true\n",
       "test.toml:3: unknown key 'no_collisions'; did you mean 'no_collision'?"},
      {w + "[expect]\nno_collision = false\n", "test.toml:3: 'no_collision' expects true"},
      {w + "[expect]\nmap_coverage = 90\n", "test.toml:3: 'map_coverage' expects a number from 0 to 1"},
      {w + "[expect]\nmean_abs_error = { a = \"x\" }\n", "test.toml:3: 'mean_abs_error' expects a number"},
      {w + "[expect]\ntick_p99_ms = { a = 1 }\n", "test.toml:3: 'tick_p99_ms' expects a number"},
      {w + "[expect]\nall_checkpoints = { a = 1 }\n", "test.toml:3: 'all_checkpoints' expects a number"},
      {w + "expect = []\n", "test.toml:2: 'expect' expects a table"},
  };
  for (const auto& [text, message] : kCorpus) {
    const std::string what = refusal(text);
    EXPECT_EQ(what.substr(0, message.size()), message) << text;
  }
}

/// Mistakes that only the world or a controller can detect.
TEST(ScenarioFile, MistakesAgainstTheWorldAreRejectedAtTheirLine) {
  const std::string w = kWorld;
  const std::pair<std::string, std::string> kCorpus[] = {
      {w + "[[robot]]\nname = \"roomba1\"\n", "test.toml:2: "},
      {w + "[default.settings]\nspeeed = 1\n", "test.toml:3: controller 'wander' has no setting 'speeed'"},
  };
  for (const auto& [text, message] : kCorpus) {
    const Scenario scenario = parse_scenario(kFile, text);
    const std::string error = refusal_from("test.toml", [&] {
      const world::World world = world_of(scenario);
      SimulationOptions options = simulation_of(scenario, world);
      control::make_controller({world}, options.actors[0].controller);
    });
    EXPECT_EQ(error.substr(0, message.size()), message) << text;
  }
}

/// Bytes removed, repeated and changed: a result or an error, never a crash.
TEST(ScenarioFile, MutantsAreReadOrRejected) {
  const std::string whole = read_scenario(SF_SOURCE_DIR "/experiments/lane-edge-pi.toml").file.empty() ? "" : R"(
world = "../worlds/testpath/testpath.world"
[default]
controller = "lane-keeping"
settings = { kp = 0.5, speed = [0.1, 0.2] }
[[robot]]
name = "roomba0"
pose = [1, 2, 90]
[expect]
mean_abs_error = { roomba0 = 0.072 }
)";
  ASSERT_FALSE(whole.empty());
  int read = 0;
  for (std::size_t i = 0; i < whole.size(); ++i)
    for (const int how : {0, 1, 2}) {
      std::string text = whole;
      if (how == 0) text.erase(i, 1);
      if (how == 1) text.insert(i, 1, whole[i]);
      if (how == 2) text[i] = static_cast<char>(text[i] ^ 0x05);
      try {
        parse_scenario(kFile, text);
        ++read;
      } catch (const base::InputError&) {
      }
    }
  EXPECT_GT(read, 100);
}

TEST(ScenarioFile, ShippedFilesAreRead) {
  int found = 0;
  for (const auto& entry : std::filesystem::directory_iterator(SF_SOURCE_DIR "/experiments")) {
    if (entry.path().extension() != ".toml") continue;
    const Scenario scenario = read_scenario(entry.path().string());
    EXPECT_TRUE(std::filesystem::exists(scenario.world)) << scenario.world;
    const world::World world = world_of(scenario);
    EXPECT_EQ(simulation_of(scenario, world).actors.size(), world.movers.size());
    ++found;
  }
  EXPECT_GE(found, 7);
}

/// The minimum and maximum number of each key, and the next numbers beyond.
TEST(ScenarioFile, NumbersEndAtTheirLimits) {
  struct Range {
    const char *table, *key, *below, *first, *last, *above;
  };
  for (const Range& r : std::initializer_list<Range>{{"", "robots", "-1", "0", "65535", "65536"},
                                                     {"", "duration", "-0.1", "0", "1e9", "1.001e9"},
                                                     {"", "seed", "-1", "0", "9000000000000000", "9000000000000002"},
                                                     {"", "tick", "0.0009", "0.001", "10", "10.001"},
                                                     {"", "start_at", "-0.1", "0", "1e9", "1.001e9"},
                                                     {"[default]\n", "rate", "0.009", "0.01", "10000", "10000.1"},
                                                     {"[link]\n", "delay", "-0.1", "0", "3600", "3600.1"},
                                                     {"[link]\n", "jitter", "-0.1", "0", "3600", "3600.1"},
                                                     {"[link]\n", "loss", "-0.1", "0", "1", "1.001"},
                                                     {"[v2v]\n", "forget", "-0.1", "0", "3600", "3601"},
                                                     {"[states]\n", "rate", "0.009", "0.01", "10000", "10000.1"},
                                                     {"[states]\n", "position_sigma", "-0.1", "0", "1", "1.001"},
                                                     {"[states]\n", "yaw_sigma", "-0.1", "0", "1", "1.001"},
                                                     {"[states]\n", "loss", "-0.1", "0", "1", "1.001"},
                                                     {"[expect]\n", "contacts", "-1", "0", "1e9", "1.001e9"},
                                                     {"[expect]\n", "mean_error", "-0.1", "0", "1e6", "1.001e6"},
                                                     {"[expect]\n", "mean_abs_error", "-0.1", "0", "1e6", "1.001e6"},
                                                     {"[expect]\n", "map_coverage", "-0.1", "0", "1", "1.001"},
                                                     {"[expect]\n", "distance", "-0.1", "0", "1e9", "1.001e9"},
                                                     {"[expect]\n", "checkpoints", "-1", "0", "1e9", "1.001e9"},
                                                     {"[expect]\n", "all_checkpoints", "-1", "0", "1e9", "1.001e9"},
                                                     {"[expect]\n", "tick_p99_ms", "-0.1", "0", "1e9", "1.001e9"}}) {
    const auto refused = [&](const char* value) {
      const std::string text = std::string(kWorld) + r.table + r.key + " = " + value + "\n";
      return refusal(text).find(std::string("'") + r.key + "'") != std::string::npos;
    };
    EXPECT_FALSE(refused(r.first) || refused(r.last)) << r.table << r.key;
    EXPECT_TRUE(refused(r.below) && refused(r.above)) << r.table << r.key;
  }
}

}  // namespace
}  // namespace sf::scenarios
