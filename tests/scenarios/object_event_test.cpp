// Doors: objects that appear and disappear during a scenario.

#include <gtest/gtest.h>

#include <filesystem>

#include "base/error.h"
#include "record/recorder.h"
#include "record/recording.h"
#include "scenarios/recording_verification.h"
#include "scenarios/run_info.h"
#include "scenarios/runner.h"
#include "scenarios/scenario_events.h"
#include "scenarios/simulation.h"
#include "sensors/laser_settings.h"
#include "tests/device.h"
#include "tests/refusal.h"
#include "tests/robots/scenes.h"

namespace sf::scenarios {
namespace {

/// A robot with a laser in a box, and a door across its path, 1 m ahead.
world::World corridor(bool with_door = true) {
  world::World world = scenes::boxed_world(6.0, 2.0, {-1.0, -1.0});
  world.interval = 0.1;
  scenes::add_mover(world, {}, scenes::rectangle({0.0, 0.0}, 0.2, 0.2))
      .sensors.push_back(
          sensors::laser_sensor({{.name = "laser", .X_MS = {0.0, 0.0, 0.04, 0.0}, .samples = 31}, 13.0}));
  if (!with_door) return world;
  world::Mover& door = scenes::add_mover(world, {1.0, 0.0, 0.0, 0.0}, scenes::rectangle({0.0, 0.0}, 0.05, 2.0));
  door.name = "tag1";
  door.is_tag = true;
  door.id = 1;
  world::update_extent_and_hash(world);
  return world;
}

SimulationOptions standing(const world::World& world) {
  return {.actors = std::vector<Actor>(world.movers.size(), Actor{.controller = {.name = ""}})};
}

std::vector<double> ranges_of(const base::TickRecord& tick) {
  std::vector<double> all;
  for (const base::ReadingBlock& reading : tick.readings)
    all.insert(all.end(), reading.values.begin(), reading.values.end());
  return all;
}

/// A reading equals that of a world without a door, bitwise, exactly while the door is open.
TEST(ObjectEvent, AnOpenDoorHasNoEffect) {
  for (const char* caster : {"host", "vulkan"}) {
    setenv("SENSORFARM_CASTER", caster, 1);
    const world::World with = corridor(), without = corridor(false);
    Simulation door(with, device(), standing(with)), none(without, device(), standing(without));
    int open = 0, closed = 0;
    for (int tick = 0; tick < 30; ++tick) {
      if (tick == 10) door.set_absent(1, true);
      if (tick == 20) door.set_absent(1, false);
      const std::vector<double> seen = ranges_of(door.step()), empty = ranges_of(none.step());
      const bool is_open = tick >= 10 && tick < 20;
      if (seen.empty()) continue;
      EXPECT_EQ(seen == empty, is_open) << caster << ", tick " << tick;
      ++(is_open ? open : closed);
    }
    EXPECT_GT(open, 5);
    EXPECT_GT(closed, 10);
  }
  unsetenv("SENSORFARM_CASTER");
}

TEST(ObjectEvent, ARobotDrivesThroughAnOpenDoorOnly) {
  for (const bool open : {false, true}) {
    const world::World world = corridor();
    Simulation simulation(world, device(), standing(world));
    simulation.set_absent(1, open);
    const std::vector<base::Twist> ahead{{0.5, 0.0, 0.0}, {}};
    double x = 0.0;
    bool contact = false;
    for (int tick = 0; tick < 60; ++tick) {
      simulation.command(ahead);
      const base::TickRecord record = simulation.step();
      x = record.reports[0].X_WM.x;
      contact = contact || record.contacts[0] != 0;
      EXPECT_EQ(base::is_absent(record.reports[1].X_WM), open);
    }
    EXPECT_EQ(contact, !open);
    EXPECT_GT(x, open ? 2.0 : 0.8);
    EXPECT_LT(x, open ? 4.9 : 0.9);
  }
}

/// The recording stores when the door was open: every scan is recomputed, also those between two ticks.
TEST(ObjectEvent, RecordingsAreVerified) {
  const world::World world = corridor();
  const std::string folder = (std::filesystem::temp_directory_path() / "object_event").string();
  {
    const sensors::SensorSet sensor_set(world);
    record::Recorder recorder(folder, run_info(world, sensor_set, {.record_readings = true}));
    Simulation simulation(world, device(), standing(world));
    for (int tick = 0; tick < 40; ++tick) {
      if (tick % 10 == 5) simulation.set_absent(1, tick % 20 == 5);
      recorder.write(simulation.step());
    }
  }
  const Verification v = verify(record::open_recording(folder), device(), {.sample = 0});
  EXPECT_TRUE(v.sound()) << v.reference.first;
  EXPECT_GT(v.reference.readings, 40u);
}

/// Objects and robots are placed by events as by `put`, and the recording is verified.
TEST(ObjectEvent, PosesAreSet) {
  const Scenario scenario = parse_scenario("test.toml",
                                           "world = \"w.world\"\n"
                                           "[[event]]\nat = 0.95\nobject = \"tag1\"\npose = [1.5, 0.25, 90]\n"
                                           "[[event]]\nat = 2\nobject = \"tag1\"\npose = [2, 0, 0.125, 0]\n"
                                           "[[event]]\nat = 3\nobject = \"r0\"\npose = [0.5, 0, 0]\n");
  world::World by_events = corridor(), by_hand = corridor();
  by_events.movers[0].name = by_hand.movers[0].name = "r0";
  world::update_extent_and_hash(by_events);
  Simulation simulation(by_events, device(), standing(by_events)), same(by_hand, device(), standing(by_hand));
  const std::string folder = (std::filesystem::temp_directory_path() / "pose_event").string();
  {
    const sensors::SensorSet sensor_set(by_events);
    record::Recorder recorder(folder, run_info(by_events, sensor_set, {.record_readings = true}));
    ScenarioEvents events(scenario);
    for (int tick = 0; tick < 40; ++tick) {
      events.apply(simulation, by_events, 0.1 * tick, [](std::uint32_t) {});
      if (tick == 10) same.put(1, {1.5, 0.25, 0.0, M_PI / 2});
      if (tick == 20) same.put(1, {2.0, 0.0, 0.125, 0.0});
      if (tick == 30) same.put(0, {0.5, 0.0, 0.0, 0.0});
      const base::TickRecord record = simulation.step();
      same.step();
      recorder.write(record);
      EXPECT_EQ(record.reports[1].X_WM.x, tick < 10 ? 1.0 : tick < 20 ? 1.5 : 2.0) << tick;
      EXPECT_EQ(record.reports[1].X_WM.z, tick < 20 ? 0.0 : 0.125) << tick;
      EXPECT_EQ(record.reports[0].X_WM.x, tick < 30 ? 0.0 : 0.5) << tick;
      EXPECT_EQ(simulation.farm().hash(), same.farm().hash()) << tick;
    }
  }
  const Verification v = verify(record::open_recording(folder), device(), {.sample = 0});
  EXPECT_TRUE(v.sound()) << v.reference.first;
  EXPECT_GT(v.reference.readings, 40u);
}

/// A robot at rest that is placed 2 m away has not driven.
TEST(ObjectEvent, APlacedRobotHasNotDriven) {
  Scenario scenario = parse_scenario(SF_SOURCE_DIR "/experiments/test.toml",
                                     "world = \"../worlds/minimagic/minimagic.world\"\nduration = 2\n[default]\n"
                                     "controller = \"patrol\"\nsettings = { points = [0, 0], speed = 0.0001 }\n"
                                     "[expect]\ndistance = { pioneer1 = 1 }\n"
                                     "[[event]]\nat = 1\nobject = \"pioneer1\"\npose = [1, 0.5, 30]\n");
  const ScenarioResult result = run_scenario(scenario, host_device());
  ASSERT_EQ(result.outcomes.size(), 1u);
  EXPECT_FALSE(result.outcomes[0].met);
}

TEST(ObjectEvent, ARemovedRobotHasNoPlace) {
  const Scenario scenario =
      parse_scenario("test.toml", "world = \"w.world\"\n[[event]]\nat = 1\nobject = \"r0\"\npose = [0, 0, 0]\n");
  world::World world = corridor();
  world.movers[0].name = "r0";
  Simulation simulation(world, host_device(), standing(world));
  simulation.remove_robot(0);
  ScenarioEvents events(scenario);
  expect_in("test.toml:2: 'r0' was removed; expected a pose before that",
            refusal_of([&] { events.apply(simulation, world, 1.0, [](std::uint32_t) {}); }));
}

TEST(ObjectEvent, EventsAfterTheEndAreReported) {
  const auto warnings = [](const std::string& at) {
    return check_scenario(
        parse_scenario(SF_SOURCE_DIR "/experiments/test.toml",
                       "world = \"../worlds/minimagic/minimagic.world\"\nduration = 10\n[[event]]\nat = " + at +
                           "\nobject = \"tag1\"\npresent = false\n"));
  };
  EXPECT_TRUE(warnings("9.9").empty());
  const auto late = warnings("10");
  ASSERT_EQ(late.size(), 1u);
  EXPECT_EQ(late[0].line, 3);
  expect_in("the event at 10 s is after the last tick of the scenario, whose duration is 10 s", late[0].message);
}

/// Recorded ticks have the states of the lights at their time.
TEST(Simulation, RecordsTheLights) {
  world::World world = corridor();
  world.lights.emplace_back().phases = {{world::LightState::green, 0.25}, {world::LightState::red, 1.0}};
  Simulation simulation(world, device(), standing(world));
  for (int tick = 0; tick < 5; ++tick) {
    const base::TickRecord record = simulation.step();
    ASSERT_EQ(record.lights.size(), 1u);
    EXPECT_EQ(record.lights[0], world::status_of(world::signal_at(world.lights[0], 0.1 * tick))) << tick;
  }
}

std::string event_refusal(const std::string& event) {
  return refusal_from("test.toml", [&] {
    check_scenario(parse_scenario(SF_SOURCE_DIR "/experiments/test.toml",
                                  "world = \"../worlds/minimagic/minimagic.world\"\n[[event]]\n" + event));
  });
}

TEST(ObjectEvent, ErrorsNameLineAndRemedy) {
  EXPECT_EQ(event_refusal("at = 1\nobject = \"tag1\"\npresent = false\n"), "");
  EXPECT_EQ(event_refusal("at = 1\nobject = \"pioneer1\"\npose = [1, 2, 30]\n"), "");
  const std::pair<std::string, std::string> kCorpus[] = {
      {"at = 1\nobject = \"tag1\"\n", "test.toml:2: 'present' is missing"},
      {"at = -1\nobject = \"tag1\"\npresent = true\n", "test.toml:3: 'at' expects a number from 0"},
      {"at = 1\nobject = \"tag9\"\npresent = true\n", "test.toml:2: "},
      {"at = 1\nobject = \"tag1\"\npresent = 1\n", "test.toml:5: 'present' expects true or false"},
      {"at = 1\nobjekt = \"tag1\"\npresent = true\n", "test.toml:4: unknown key 'objekt'; did you mean 'object'?"},
      {"at = 1\nobject = \"tag1\"\npose = [1, 2]\n",
       "test.toml:5: 'pose' expects [x, y, yaw], [x, y, z, yaw] or [x, y, z, roll, pitch, yaw]"},
      {"at = 1\nobject = \"tag1\"\npose = [1, 2e7, 0]\n", "test.toml:5: 'pose' expects a number from -1"},
      {"at = 1\nobject = \"pioneer1\"\npresent = false\n", "test.toml:2: 'pioneer1' has sensors or a controller"},
  };
  for (const auto& [text, message] : kCorpus) EXPECT_EQ(event_refusal(text).substr(0, message.size()), message) << text;
}

}  // namespace
}  // namespace sf::scenarios
