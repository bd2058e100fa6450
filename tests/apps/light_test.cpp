// `light`: a process that sends to a robot.

#include <gtest/gtest.h>

#include "base/elapsed.h"
#include "tests/apps/json.h"
#include "tests/apps/program.h"

namespace sf {

namespace {

/// Ports for SimVille's sensor packets that no other test uses, for `serve` and `robot`.
Words town_ports() {
  Words words;
  for (const std::string type : {"laser", "laneedge", "magnetometer", "encoder", "gyro", "gps"}) {
    words.push_back("--" + type + "-port");
    words.push_back(std::to_string(free_ports(64)));
  }
  return words;
}

}  // namespace

TEST(Light, ARobotReceivesIt) {
  const std::string world = our_world("simville/simville.world");
  const std::string spat = std::to_string(free_ports(1));
  Program light({"light", world, "--send", "127.0.0.1", "--port", spat, "--set", "light1=flashing red"});
  ASSERT_TRUE(light.prints("7 lights of 2 intersections to 127.0.0.1:" + spat + " at 10 Hz"));
  // There is no farm: the robot has no readings, but still receives the lights.
  const Outcome robot =
      run_program(with({"robot", world, "--name", "roomba0", "--controller", "route", "--set", "tour=true",
                        "--stop-after", "0", "--duration", "2.5", "--spat", spat, "--json"},
                       town_ports()));
  const Json facts(robot.out);
  EXPECT_GE(facts.number("/spat/messages"), 2.0) << robot.err;
  EXPECT_EQ(facts.number("/spat/invalid"), 0.0);
  EXPECT_GE(facts.number("/spat/others"), 1.0) << "MAP, once a second";
}

/// On both sides, as for robots.
TEST(Light, AKeyMismatchIsReported) {
  const Folder folder;
  const std::string port = std::to_string(free_ports(1));
  const auto peers = [&](const std::string& name, char digit) {
    return folder.write(name, "[[peer]]\nlight = 1\nkey = \"" + std::string(64, digit) + "\"\n");
  };
  Program farm(with({"serve", our_world("simville/simville.world"), "--port", port, "--peers", peers("farm.toml", '1')},
                    town_ports()));
  ASSERT_TRUE(farm.prints("press Ctrl-C to stop")) << farm.err();
  Program light(
      {"light", our_world("simville/lights.toml"), "--farm", "127.0.0.1:" + port, "--peers", peers("light.toml", '2')});
  EXPECT_TRUE(light.prints("has another key for intersection 1 than --peers here")) << light.err();
  EXPECT_TRUE(farm.prints("intersection 1 at 127.0.0.1:")) << farm.err();
}

/// Two seconds of an actuated plan, with a farm whose robot is at a detector.
TEST(Light, RunsAPlanWithAFarm) {
  const std::string port = std::to_string(free_ports(1));
  const Words ports = town_ports();
  Program farm(with({"serve", our_world("simville/simville.world"), "--port", port, "--json"}, ports));
  ASSERT_TRUE(farm.prints("press Ctrl-C to stop")) << farm.err();
  Program robot(with({"robot", our_world("simville/simville.world"), "--name", "roomba0", "--controller", "route",
                      "--set", "tour=true", "--stop-after", "0", "--port", port, "--json"},
                     ports));
  ASSERT_TRUE(robot.prints("press Ctrl-C to stop")) << robot.err();
  const Outcome light = run_successfully(
      {"light", our_world("simville/lights.toml"), "--farm", "127.0.0.1:" + port, "--rate", "20", "--duration", "2"});
  EXPECT_NE(light.err.find("7 lights of 2 intersections to 127.0.0.1:" + port + " (V2I) at 20 Hz"), std::string::npos);
  EXPECT_EQ(light.err.find("no packets from"), std::string::npos) << light.err;
  const Json report(robot.stop().out);
  EXPECT_GE(report.number("/lights/packets"), 4.0);
  const Json facts(farm.stop().out);
  EXPECT_GE(facts.number("/lights/packets"), 20.0) << "of both intersections";
  EXPECT_GE(facts.number("/lights/sent"), 4.0);
  EXPECT_FALSE(facts.has("/received/stale"));
}

/// Long before the next message, which is due in ten seconds.
TEST(Light, CtrlCEndsItAtOnce) {
  Program light({"light", our_world("simville/simville.world"), "--send", "127.0.0.1", "--port",
                 std::to_string(free_ports(1)), "--rate", "0.1"});
  ASSERT_TRUE(light.prints("press Ctrl-C to stop"));
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(light.stop().code, 0);
  EXPECT_LT(base::seconds_since(start), 5.0) << "0.05 s on an idle machine";
}

TEST(Light, WrongArgumentsAreRejected) {
  const std::string world = our_world("simville/simville.world");
  const Folder folder;
  struct Case {
    Words words;
    const char* message;
  };
  for (const Case& c : std::vector<Case>{
           {{"light", world}, "expected a receiver: --send HOST for SPaT and MAP, --farm HOST:PORT for V2I, or both"},
           {{"light", world, "--farm", "127.0.0.1"}, "--farm: expected HOST:PORT, got '127.0.0.1'"},
           {{"light", folder.write("p.toml", "world = \"" + world + "\"\n[[program]]\nlights = [\"ligth1\"]\n"),
             "--send", "127.0.0.1"},
            "p.toml:3: no light of the world is called 'ligth1'; did you mean 'light1'?"},
           {{"light", folder.write("q.toml", "[[program]]\n"), "--send", "127.0.0.1"}, "q.toml:"},
           {{"light", our_world("rooms.world"), "--send", "127.0.0.1"}, "no traffic lights in this world"},
           {{"light", world, "--send", "127.0.0.1", "--set", "ligth1=red"}, "did you mean 'light1'?"},
           {{"light", world, "--send", "127.0.0.1", "--set", "light1=blue"},
            "expected NAME=STATE with one of dark, red"},
           {{"light", world, "--send", "127.0.0.1", "--set", "light1"}, "--set: expected NAME=STATE"},
           {{"light", "--send", "127.0.0.1", "--port", "9010", "9011", world}, "was not expected"},
           {{"light", world, "--send", "127.0.0.1", "--port", "0"}, "--port"},
           {{"light", world, "--send", "127.0.0.1", "--rate", "0"}, "--rate"}}) {
    expect_refused(c.words, c.message);
  }
}

}  // namespace sf
