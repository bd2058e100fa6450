// Processes on loopback, one of which is killed, stopped, behind a bad link, or has a jumping clock. Each test waits
// for messages, not for times: a process that does not recover fails it after a minute.

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <memory>

#include "tests/apps/remote_robot.h"
#include "tests/instrumented.h"

namespace sf {

namespace {

const char* const kHall = R"(
model( name "hall" size [8 6 1] boundary 1 noblocks 0 color "gray" )
define bot position( size [0.3 0.3 0.1]
  laser( samples 91 fov 180 range_max 8 pose [0.1 0 -0.06 0] size [0 0 0.04] ) )
bot( name "roomba1" pose [-2 0 0 0] )
bot( name "roomba2" pose [2 1 0 180] )
light( name "lamp" pose [0 2 0 0] size [0.1 0.1 0.5] phases 1 phase[0] ["red" 1] )
model( name "tag1" pose [0 -2 0 0] size [0.3 0.3 0.5] )
)";

const char* const kOverhead =
    "dictionary = \"aruco_4x4_50\"\ntag_side = 0.15\ntag_height = 0.2\n[[camera]]\nname = \"a\"\nsize = [320, 240]\n"
    "focal = [400, 400]\nposition = [0, 0, 2.2]\n[[tag]]\nid = 1\n";

constexpr const char* kStops = "stops until one arrives";
constexpr const char* kResumes = "continues";

/// A farm on a port that it keeps across restarts, and the files that it needs.
struct Hall {
  Folder folder;
  std::string world = folder.write("hall.world", kHall);
  std::string port = std::to_string(free_ports(1));
  std::string lasers = std::to_string(free_ports(48));

  std::unique_ptr<Program> serve(const Words& more = {}) const {
    const Words words = with({"serve", world, "--port", port, "--json", "--laser-port", lasers}, more);
    auto farm = std::make_unique<Program>(words);
    EXPECT_TRUE(farm->prints("; press Ctrl-C to stop")) << farm->err();
    return farm;
  }
  std::unique_ptr<Program> robot(const std::string& name, const Words& more = {}) const {
    const Words words = with({"robot", world, "--name", name, "--port", port, "--laser-port", lasers, "--json"}, more);
    return std::make_unique<Program>(words);
  }
  /// Long enough for the other robots, which started earlier, to be served.
  void drive_for_a_while(const std::string& name, const std::string& seconds = "0.8") const {
    const Outcome outcome = robot(name, {"--duration", seconds})->wait();
    EXPECT_EQ(outcome.code, 0) << outcome.err;
  }
};

Json ended(Program& program) {
  const Outcome outcome = program.stop();
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  return Json(outcome.out);
}

TEST(Faults, ARobotSurvivesTheRestartOfItsFarm) {
  const Hall hall;
  auto farm = hall.serve({"--record", hall.folder.path("first")});
  const auto robot = hall.robot("roomba1");
  hall.drive_for_a_while("roomba2");
  EXPECT_EQ(farm->stop(SIGKILL).signal, SIGKILL);
  ASSERT_TRUE(robot->prints(kStops)) << robot->err();
  farm = hall.serve();
  ASSERT_TRUE(robot->prints(kResumes)) << robot->err();
  EXPECT_GE(ended(*robot).number("/stops"), 1.0);
  ended(*farm);
  // The killed farm's recording contains every tick that was written.
  run_successfully({"verify", hall.folder.path("first"), "--json"});
}

TEST(Faults, AStoppedFarmResumesWithItsClocks) {
  const Hall hall;
  const auto farm = hall.serve({"--filter"});
  const auto robot = hall.robot("roomba1");
  hall.drive_for_a_while("roomba2");
  farm->signal(SIGSTOP);
  ASSERT_TRUE(robot->prints(kStops)) << robot->err();
  farm->signal(SIGCONT);
  ASSERT_TRUE(robot->prints(kResumes)) << robot->err();
  ended(*robot);
  EXPECT_EQ(ended(*farm).size("/states/clocks"), 2u);
}

TEST(Faults, ARestartedRobotIsAcceptedAgain) {
  const Hall hall;
  const auto farm = hall.serve({"--filter"});
  auto robot = hall.robot("roomba1");
  hall.drive_for_a_while("roomba2");
  robot->signal(SIGKILL);  // no LEAVE: its id is bound to its old address for two seconds
  EXPECT_EQ(robot->wait().signal, SIGKILL);
  robot = hall.robot("roomba1", {"--duration", "3.2"});
  const Outcome outcome = robot->wait();
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_GE(Json(outcome.out).number("/readings/laser"), 5.0) << outcome.out;
  ended(*farm);
}

/// The new process binds the light's id two seconds after the killed one's last packet, and then receives robot states.
TEST(Faults, ARestartedLightIsAcceptedAgain) {
  const Hall hall;
  const auto farm = hall.serve();
  const auto robot = hall.robot("roomba1");
  const Words words{"light", hall.world, "--farm", "127.0.0.1:" + hall.port, "--set", "lamp=green"};
  auto light = std::make_unique<Program>(words);
  hall.drive_for_a_while("roomba2");
  EXPECT_EQ(light->stop(SIGKILL).signal, SIGKILL);
  Words again = words;
  for (const char* word : {"--duration", "2.7"}) again.emplace_back(word);
  const Outcome outcome = run_successfully(again);
  EXPECT_EQ(outcome.err.find("heard 0"), std::string::npos) << outcome.err;
  const Json driven = ended(*robot), service = ended(*farm);
  EXPECT_GE(driven.number("/lights/packets"), 10.0) << "without a pause in the farm's packets";
  EXPECT_GE(service.number("/lights/packets"), 10.0);
  EXPECT_GE(service.number("/received/wrong source"), 1.0) << "the second was refused while the first was bound";
}

TEST(Faults, ARestartedCameraIsAcceptedAgain) {
  const Hall hall;
  const auto farm = hall.serve();
  // Packets of the other tag arrive at this socket: once one has, the farm has received some, too.
  const netio::Socket here = netio::open_udp({netio::kLoopback, 0});
  const std::string testbed =
      hall.folder.write("overhead.toml", kOverhead + std::string("[[tag]]\nid = 2\naddress = \"") +
                                             netio::endpoint_text(netio::bound_endpoint(here)) + "\"\n");
  Words words{"vps", testbed, "--rendered", "2", "--real-time", "--send", "127.0.0.1:" + hall.port};
  {
    Program camera(words);
    ASSERT_TRUE(until([&] { return netio::ReceiveBatch(1).fill(here) > 0; })) << camera.err();
    EXPECT_EQ(camera.stop(SIGKILL).signal, SIGKILL);
  }
  for (const char* word : {"--duration", "3.2"}) words.emplace_back(word);
  run_successfully(words);
  // The first process sent only a few: these are from the second.
  EXPECT_GE(ended(*farm).number("/received/accepted"), 15.0);
}

/// Only the wall clock jumps: tick clocks do not, and signature counters continue.
TEST(Faults, AClockJumpOfAnHourStopsNoRobot) {
  const std::string library = "/usr/lib/x86_64-linux-gnu/faketime/libfaketime.so.1";
  if (instrumented()) GTEST_SKIP() << "AddressSanitizer must be the first library, as libfaketime must";
  if (!std::filesystem::exists(library)) GTEST_SKIP() << "this machine has no libfaketime (script/setup check)";
  const Hall hall;
  const std::string jump = hall.folder.write("jump", "+0");
  const Environment moved{{"LD_PRELOAD", library},
                          {"FAKETIME_TIMESTAMP_FILE", jump},
                          {"FAKETIME_NO_CACHE", "1"},
                          {"DONT_FAKE_MONOTONIC", "1"}};
  const std::string peers =
      hall.folder.write("peers.toml", "[[peer]]\nrobot = 1\nkey = \"" + std::string(64, '7') + "\"\n");
  Program farm(
      {"serve", hall.world, "--port", hall.port, "--json", "--laser-port", hall.lasers, "--filter", "--peers", peers},
      moved);
  ASSERT_TRUE(farm.prints("; press Ctrl-C to stop")) << farm.err();
  Program robot({"robot", hall.world, "--name", "roomba1", "--port", hall.port, "--laser-port", hall.lasers, "--json",
                 "--peers", peers},
                moved);
  for (const char* hours : {"+3600", "-3600", "+0"}) {
    hall.folder.write("jump", hours);
    hall.drive_for_a_while("roomba2", "0.6");
  }
  const Json driven = ended(robot);
  EXPECT_EQ(driven.number("/stops"), 0.0) << "its readings never paused";
  EXPECT_GE(driven.number("/readings/laser"), 8.0);
  const Json service = ended(farm);
  EXPECT_EQ(service.has("/received/replayed"), false) << "counters continue";
  EXPECT_EQ(service.has("/states/by_verdict/future"), false);
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
