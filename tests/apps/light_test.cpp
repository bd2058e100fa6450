// `light`: a process that sends, beside a robot that listens.

#include <gtest/gtest.h>

#include <csignal>

#include "base/elapsed.h"
#include "tests/apps/json.h"
#include "tests/apps/program.h"

namespace sf {

TEST(Light, ARobotHearsIt) {
  const std::string world = our_world("simville/simville.world");
  const std::string lasers = std::to_string(free_ports(48)), spat = std::to_string(free_ports(1));
  Program light({"light", world, "--send", "127.0.0.1", "--port", spat, "--set", "light1=flashing red"});
  ASSERT_TRUE(light.says("7 lights of 2 intersections to 127.0.0.1:" + spat + " at 10 Hz"));
  // There is no farm: the robot has no readings, and hears the lights all the same.
  const Outcome robot =
      run_program({"robot", world, "--name", "roomba0", "--controller", "route", "--set", "tour=true", "--stop-after",
                   "0", "--duration", "2.5", "--spat", spat, "--laser-port", lasers, "--json"});
  const Json facts(robot.out);
  EXPECT_GE(facts.number("/spat/messages"), 2.0) << robot.err;
  EXPECT_EQ(facts.number("/spat/invalid"), 0.0);
  EXPECT_GE(facts.number("/spat/others"), 1.0) << "MAP, once a second";
}

TEST(Light, EndsAfterItsDuration) {
  const Outcome outcome = run_program({"light", our_world("simville/simville.world"), "--send", "127.0.0.1", "--port",
                                       std::to_string(free_ports(1)), "--duration", "0.1"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("sent "), std::string::npos) << outcome.err;
}

/// Far from the next message, which is due in ten seconds.
TEST(Light, CtrlCEndsItAtOnce) {
  Program light({"light", our_world("simville/simville.world"), "--send", "127.0.0.1", "--port",
                 std::to_string(free_ports(1)), "--rate", "0.1"});
  ASSERT_TRUE(light.says("Ctrl-C ends it"));
  const auto start = std::chrono::steady_clock::now();
  light.signal(SIGINT);
  EXPECT_EQ(light.wait().code, 0);
  EXPECT_LT(base::seconds_since(start), 5.0) << "0.05 s on an idle machine";
}

TEST(Light, WrongArgumentsAreExplained) {
  const std::string world = our_world("simville/simville.world");
  struct Case {
    Words words;
    const char* said;
  };
  for (const Case& c : std::vector<Case>{
           {{"light", world}, "--send is required"},
           {{"light", our_world("rooms.world"), "--send", "127.0.0.1"}, "no traffic lights in this world"},
           {{"light", world, "--send", "127.0.0.1", "--set", "ligth1=red"}, "did you mean 'light1'?"},
           {{"light", world, "--send", "127.0.0.1", "--set", "light1=blue"},
            "expected NAME=STATE with one of dark, red"},
           {{"light", world, "--send", "127.0.0.1", "--set", "light1"}, "--set: expected NAME=STATE"},
           {{"light", "--send", "127.0.0.1", "--port", "9010", "9011", world}, "was not expected"},
           {{"light", world, "--send", "127.0.0.1", "--port", "0"}, "--port"},
           {{"light", world, "--send", "127.0.0.1", "--rate", "0"}, "--rate"}}) {
    const Outcome outcome = run_program(c.words);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_NE(outcome.err.find(c.said), std::string::npos) << outcome.err;
  }
}

}  // namespace sf
