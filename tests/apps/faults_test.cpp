// Processes on loopback with one of them killed, stopped, or behind a bad link. Each test waits for messages, not for
// times: a process that does not recover fails it after a minute.

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <memory>

#include "tests/apps/json.h"
#include "tests/apps/program.h"

namespace sf {

namespace {

const char* const kHall = R"(
model( name "hall" size [8 6 1] boundary 1 noblocks 0 color "gray" )
define bot position( size [0.3 0.3 0.1]
  laser( samples 91 fov 180 range_max 8 pose [0.1 0 -0.06 0] size [0 0 0.04] ) )
bot( name "roomba1" pose [-2 0 0 0] )
bot( name "roomba2" pose [2 1 0 180] )
)";

constexpr const char* kStands = "stands until one comes";
constexpr const char* kGoesOn = "goes on";

/// A farm on a port that it keeps through restarts, with what it needs to be found.
struct Hall {
  Folder folder;
  std::string world = folder.write("hall.world", kHall);
  std::string port = std::to_string(free_ports(1));
  std::string lasers = std::to_string(free_ports(48));

  std::unique_ptr<Program> serve(const Words& more = {}) const {
    Words words{"serve", world, "--port", port, "--json", "--laser-port", lasers};
    words.insert(words.end(), more.begin(), more.end());
    auto farm = std::make_unique<Program>(words);
    EXPECT_TRUE(farm->says("; Ctrl-C ends it")) << farm->err();
    return farm;
  }
  std::unique_ptr<Program> robot(const std::string& name, const Words& more = {}) const {
    Words words{"robot", world, "--name", name, "--port", port, "--laser-port", lasers, "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return std::make_unique<Program>(words);
  }
  /// Long enough for the others, which began before, to be served.
  void drive_for_a_while(const std::string& name) const {
    const Outcome outcome = robot(name, {"--duration", "2"})->wait();
    EXPECT_EQ(outcome.code, 0) << outcome.err;
  }
};

Json ended(Program& program) {
  program.signal(SIGINT);
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  return Json(outcome.out);
}

TEST(Faults, ARobotSurvivesTheRestartOfItsFarm) {
  const Hall hall;
  auto farm = hall.serve({"--record", hall.folder.path("first")});
  const auto robot = hall.robot("roomba1");
  hall.drive_for_a_while("roomba2");
  farm->signal(SIGKILL);
  EXPECT_EQ(farm->wait().signal, SIGKILL);
  ASSERT_TRUE(robot->says(kStands)) << robot->err();
  farm = hall.serve();
  ASSERT_TRUE(robot->says(kGoesOn)) << robot->err();
  EXPECT_GE(ended(*robot).number("/stops"), 1.0);
  ended(*farm);
  // The killed farm's recording has every tick that was written.
  const Outcome verified = run_program({"verify", hall.folder.path("first"), "--json"});
  EXPECT_EQ(verified.code, 0) << verified.out << verified.err;
}

TEST(Faults, AStoppedFarmGoesOnWhereItsClockIs) {
  const Hall hall;
  const auto farm = hall.serve({"--filter"});
  const auto robot = hall.robot("roomba1");
  hall.drive_for_a_while("roomba2");
  farm->signal(SIGSTOP);
  ASSERT_TRUE(robot->says(kStands)) << robot->err();
  farm->signal(SIGCONT);
  ASSERT_TRUE(robot->says(kGoesOn)) << robot->err();
  ended(*robot);
  EXPECT_EQ(ended(*farm).size("/states/clocks"), 2u);
}

TEST(Faults, ARestartedRobotIsHeardAgain) {
  const Hall hall;
  const auto farm = hall.serve({"--filter"});
  auto robot = hall.robot("roomba1");
  hall.drive_for_a_while("roomba2");
  robot->signal(SIGKILL);  // no LEAVE: its id is bound to its old address for two seconds
  EXPECT_EQ(robot->wait().signal, SIGKILL);
  robot = hall.robot("roomba1", {"--duration", "4"});
  const Outcome outcome = robot->wait();
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_GE(Json(outcome.out).number("/readings/laser"), 5.0) << outcome.out;
  ended(*farm);
}

TEST(Faults, ABadLinkIsCountedOnBothSides) {
  const Hall hall;
  const auto farm = hall.serve({"--filter"});
  const auto robot = hall.robot("roomba1", {"--duration", "3", "--delay", "0.02", "--jitter", "0.06", "--loss", "0.1",
                                            "--duplicate", "0.2", "--corrupt", "0.2"});
  const Outcome outcome = robot->wait();
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const Json facts(outcome.out);
  EXPECT_GE(facts.number("/readings/laser"), 5.0) << outcome.out;
  EXPECT_GT(facts.number("/injected/out/duplicated"), 0.0);
  EXPECT_GT(facts.number("/injected/out/corrupted"), 0.0);
  const Json service = ended(*farm);
  EXPECT_GT(service.number("/states/by_verdict/replayed"), 0.0) << "second copies";
  EXPECT_GT(service.size("/received"), 1u) << "flipped bits";
}

}  // namespace

}  // namespace sf
