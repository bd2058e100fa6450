// `robot` processes with `serve`, over loopback, in real time: short, without requirements on their speed.

#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <memory>

#include "tests/apps/json.h"
#include "tests/apps/program.h"
#include "tests/create_simulator.h"
#include "tests/khepera_emulator.h"
#include "tests/pioneer_emulator.h"
#include "tests/viz/png.h"

namespace sf {

namespace {

// The first robot's scans need three datagrams each, those of the others one.
const char* const kRoom = R"(
model( name "room" size [8 6 1] boundary 1 noblocks 0 color "gray" )
define bot position( size [0.3 0.3 0.1] )
define eye laser( samples 91 fov 180 range_max 8 pose [0.1 0 -0.06 0] size [0 0 0.04] )
bot( name "roomba1" pose [-2 0 0 0] laser( samples 700 fov 180 range_max 8 pose [0.1 0 -0.06 0] size [0 0 0.04] ) )
bot( name "roomba2" pose [2 1 0 0] eye( ) )
bot( name "roomba3" pose [2 -1 0 0] eye( ) )
bot( name "roomba4" pose [0 2 0 0] eye( ) )
)";

// The thesis' layout has no room for that many rays.
const char* const kSmallRoom = R"(
model( name "room" size [8 6 1] boundary 1 noblocks 0 color "gray" )
position( name "roomba2" pose [2 1 0 0] size [0.3 0.3 0.1]
  laser( samples 91 fov 180 range_max 8 pose [0.1 0 -0.06 0] size [0 0 0.04] ) )
)";

struct FarmService {
  Folder folder;
  std::string world;
  std::string lasers = std::to_string(free_ports(48));
  Program program;
  std::string port;

  explicit FarmService(const std::string& wire = "farm")
      : world(folder.write("room.world", wire == "farm" ? kRoom : kSmallRoom)),
        program({"serve", world, "--port", "0", "--json", "--wire", wire, "--laser-port", lasers}) {
    if (!program.prints("; press Ctrl-C to stop")) return;
    const std::string message = program.err();
    port = std::to_string(std::atoi(message.c_str() + message.find("127.0.0.1:") + 10));
  }
  std::unique_ptr<Program> robot(const std::string& name, const Words& more) const {
    const Words words = with({"robot", world, "--name", name, "--port", port, "--laser-port", lasers, "--json"}, more);
    return std::make_unique<Program>(words);
  }
  Json end() { return Json(program.stop().out); }
};

Json facts_of(const std::unique_ptr<Program>& robot, int code = 0) {
  const Outcome outcome = robot->wait();
  EXPECT_EQ(outcome.code, code) << outcome.err;
  return Json(outcome.out);
}

/// Counts of received and sent packets match the packets that the injected link delivered.
void expect_sums(const Json& facts) {
  EXPECT_EQ(facts.number("/injected/in/passed"),
            facts.number("/sensor_packets/packets") + facts.number("/relayed/packets"));
  EXPECT_EQ(facts.number("/injected/out/passed"), facts.number("/sent/packets"));
}

double number_or_none(const Json& facts, const std::string& pointer) {
  return facts.has(pointer) ? facts.number(pointer) : 0.0;
}

struct RobotsTest : testing::Test {
  /// A robot without a farm needs three seconds, which run in parallel with the other tests.
  static void SetUpTestSuite() {
    silent_folder = std::make_unique<Folder>();
    const std::string world = silent_folder->write("room.world", kRoom);
    silent =
        std::make_unique<Program>(Words{"robot", world, "--name", "roomba1", "--port", std::to_string(free_ports(1)),
                                        "--laser-port", std::to_string(free_ports(48)), "--duration", "3.3"});
    EXPECT_TRUE(silent->prints("; press Ctrl-C to stop"));
  }
  static void TearDownTestSuite() {
    silent.reset();
    silent_folder.reset();
  }
  static std::unique_ptr<Folder> silent_folder;
  static std::unique_ptr<Program> silent;
};
std::unique_ptr<Folder> RobotsTest::silent_folder;
std::unique_ptr<Program> RobotsTest::silent;

}  // namespace

TEST_F(RobotsTest, SeveralDriveByTheirReadings) {
  FarmService service;
  ASSERT_FALSE(service.port.empty()) << service.program.err();
  const auto one = service.robot("roomba1", {"--duration", "2"});
  const auto two = service.robot("roomba2", {"--duration", "2", "--wait-for-start"});
  const auto three = service.robot("roomba3", {"--duration", "2", "--loss", "1", "--wait-for-start"});
  const auto four =
      service.robot("roomba4", {"--duration", "2", "--loss", "0.3", "--delay", "0.02", "--jitter", "0.15"});
  ASSERT_TRUE(two->prints("after the start signal"));
  constexpr int kStarts = 3;
  for (int i = 0; i < kStarts; ++i) {
    const Outcome started = run_successfully({"start", "--port", service.port, "--robot", "2"});
    EXPECT_NE(started.err.find("for robot 2, 3 times; it is not acknowledged"), std::string::npos) << started.err;
  }

  const Json f1 = facts_of(one), f2 = facts_of(two), f3 = facts_of(three, 1), f4 = facts_of(four);
  for (const Json* facts : {&f1, &f2, &f3, &f4}) expect_sums(*facts);
  // It receives all three parts of its scans and the states of others, and it drives.
  EXPECT_TRUE(f1.number("/readings/laser") > 0);
  EXPECT_GE(f1.number("/sensor_packets/by_reason/accepted"), 3 * f1.number("/readings/laser"));
  EXPECT_GT(f1.number("/relayed/by_reason/accepted"), 0);
  EXPECT_GT(f1.number("/distance_m"), 0.05);
  EXPECT_GE(f1.number("/sent/packets"), f1.number("/steps"));
  EXPECT_LT(f1.number("/sent/packets"), 12.0 * f1.number("/wall_s") + 9.0) << "10 states a second, and 2 requests";
  // The second waited, then drove.
  EXPECT_GT(f2.number("/steps"), 0);
  EXPECT_TRUE(f2.flag("/started"));
  EXPECT_GT(f2.number("/distance_m"), 0.0);
  // The third neither was received by anyone nor received the signal.
  EXPECT_FALSE(f3.flag("/started"));
  EXPECT_EQ(f3.number("/steps"), 0);
  EXPECT_EQ(f3.number("/distance_m"), 0.0);
  EXPECT_EQ(f3.number("/sent/packets"), 0);
  EXPECT_GT(f3.number("/injected/out/lost"), 0);
  EXPECT_EQ(f3.number("/injected/in/passed"), 0);
  EXPECT_EQ(f3.number("/readings/laser"), 0);
  // A bad link degrades the service but does not break it.
  EXPECT_GT(f4.number("/injected/in/lost"), 0);
  EXPECT_GT(f4.number("/readings/laser"), 0);

  const Json farm = service.end();
  EXPECT_GE(farm.number("/received/unproven"), 3);  // the first packet of each, before it proved its address
  EXPECT_EQ(
      farm.number("/received/accepted") + number_or_none(farm, "/received/stale") + farm.number("/received/unproven"),
      f1.number("/sent/packets") + f2.number("/sent/packets") + f4.number("/sent/packets") + 3 * kStarts);
  EXPECT_GE(farm.number("/relayed/starts"), 1);
  EXPECT_GE(farm.number("/relayed/states"), f1.number("/relayed/by_reason/accepted"));
}

TEST_F(RobotsTest, ReadTheThesisLayoutToo) {
  FarmService service("thesis");
  ASSERT_FALSE(service.port.empty()) << service.program.err();
  const Json facts = facts_of(service.robot("roomba2", {"--duration", "1", "--wire", "thesis"}));
  expect_sums(facts);
  EXPECT_GT(facts.number("/readings/laser"), 0);
  EXPECT_GT(facts.number("/distance_m"), 0.0);
}

/// Two robots' own maps are merged: each sees a wall that is out of range of the other.
TEST_F(RobotsTest, SendTheirOwnMaps) {
  FarmService service;
  ASSERT_FALSE(service.port.empty()) << service.program.err();
  const unsigned ports = free_ports(2);
  Program map({"map", "--listen", std::to_string(ports), "--listen", std::to_string(ports + 1), "--merge", "--once",
               "--silence", "60"});
  const auto robot = [&](const std::string& name, unsigned port, const Words& more) {
    return service.robot(name, with({"--duration", "2", "--map", "127.0.0.1:" + std::to_string(port)}, more));
  };
  const std::string picture = service.folder.path("map.png");
  const auto two = robot("roomba2", ports, {});
  const auto four = robot("roomba4", ports + 1, {"--map-file", picture, "--view", "0"});
  EXPECT_TRUE(four->prints("view on http://127.0.0.1:")) << four->err();
  EXPECT_TRUE(until([&] { return std::filesystem::exists(picture) || !four->running(); }));
  EXPECT_TRUE(four->running()) << "the picture appears while it drives";
  for (const Json& facts : {facts_of(two), facts_of(four)}) {
    EXPECT_GT(facts.number("/own_map/scans"), 0);
    EXPECT_GT(facts.number("/own_map/maps"), 0);
  }
  EXPECT_GT(scenes::read_png(picture).count(0xFFFEFEFEu), 1000) << "free cells";
  EXPECT_FALSE(std::filesystem::exists(picture + ".part"));
  const Outcome outcome = map.stop();
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_GT(std::count(outcome.out.begin(), outcome.out.end(), '1'), 0) << outcome.out;
  EXPECT_GT(std::count(outcome.out.begin(), outcome.out.end(), ' '), 20) << outcome.out;
}

/// Successive processes with the same name: each is accepted from its first packet on.
TEST_F(RobotsTest, SuccessiveProcessesAreAcceptedAtOnce) {
  FarmService service;
  ASSERT_FALSE(service.port.empty()) << service.program.err();
  double sent = 0.0;
  for (int i = 0; i < 3; ++i) {
    const Json facts = facts_of(service.robot("roomba2", {"--duration", "0.5"}));
    EXPECT_GT(facts.number("/readings/laser"), 0) << i;
    sent += facts.number("/sent/packets");
  }
  const Json farm = service.end();
  EXPECT_EQ(farm.number("/received/accepted") + farm.number("/received/unproven"), sent);
  EXPECT_FALSE(farm.has("/received/wrong source"));
}

TEST(Robot, WrongArgumentsAreRejectedWithTheExpectedOnes) {
  const Folder folder;
  const std::string world = folder.write("room.world", kSmallRoom);
  struct Case {
    Words more;
    std::string message;
  };
  const Case cases[] = {
      {{"--name", "roomba3"}, "has no robot 'roomba3'; did you mean 'roomba2'?"},  // one typo
      {{"--name", "bus"}, "has no robot 'bus'; it has roomba"},
      {{}, "--name"},  // the name is required
      {{"--name", "roomba2", "--controller", "wonder"}, "got 'wonder'"},
      {{"--name", "roomba2", "--set", "speed"}, "expected KEY=VALUE"},
      {{"--name", "roomba2", "--set", "sped=1"}, "has no setting 'sped'"},
      {{"--name", "roomba2", "--map", "52000"}, "expected HOST:PORT"},
      {{"--name", "roomba2", "--map", "127.0.0.1:0"}, "expected HOST:PORT"},
      {{"--name", "roomba2", "--map-file", "map.gif"}, "pictures are PNG, SVG or PDF files"},
      {{"--name", "roomba2", "--serial", "/dev/ttyNONE0"}, "`ls /dev/ttyUSB* /dev/ttyACM*`"},
      {{"--name", "roomba2", "--serial", "/dev/null"}, "is not a serial line"},
      {{"--name", "roomba2", "--serial", "/dev/null", "--baud", "1200"}, "57600"},
      {{"--name", "roomba2", "--serial", "/dev/null", "--robot-type", "kepera"}, "khepera"},
      {{"--name", "roomba2", "--robot-type", "khepera"}, "--serial"},
      {{"--name", "roomba2", "--server", "no.such.host.invalid"}, "no.such.host.invalid"},
  };
  for (const Case& each : cases) {
    expect_refused(with({"robot", world, "--duration", "0.1"}, each.more), each.message);
  }
}

/// It has no sensors, so receiving nothing is not a failure.
TEST(Robot, WithoutSensorsItNeedsNoFarm) {
  const Folder folder;
  const std::string world = folder.write("blind.world", "position( name \"blind\" size [0.3 0.3 0.1] )\n");
  const Outcome outcome = run_successfully(
      {"robot", world, "--name", "blind", "--port", std::to_string(free_ports(1)), "--duration", "0.3", "--json"});
  EXPECT_GT(Json(outcome.out).number("/distance_m"), 0.0);
}

/// A patrol that stops before the other robot, which it knows by V2V only.
TEST(Robot, SeesOthersByV2vWithoutAFarm) {
  const Folder folder;
  const std::string world =
      folder.write("pair.world",
                   "define bot position( size [0.3 0.3 0.1] )\n"
                   "bot( name \"robot1\" pose [0 0 0 0] )\nbot( name \"robot2\" pose [1 0 0 0] )\n");
  const unsigned ports = free_ports(3);
  const auto robot = [&](const std::string& name, const std::string& point, unsigned own, unsigned other) {
    return std::make_unique<Program>(Words{"robot", world, "--name", name, "--port", std::to_string(ports + 2),
                                           "--controller", "patrol", "--set", point, "--set", "speed=0.5",
                                           "--v2v-peers", "127.0.0.1:" + std::to_string(other), "--v2v-port",
                                           std::to_string(own), "--duration", "2.5", "--json"});
  };
  const auto still = robot("robot2", "points=1 0", ports + 1, ports);
  ASSERT_TRUE(still->prints("; press Ctrl-C to stop")) << still->err();
  const auto drives = robot("robot1", "points=5 0", ports, ports + 1);
  const Json facts = facts_of(drives);
  EXPECT_GT(facts.number("/direct_v2v/by_reason/accepted"), 0);
  EXPECT_GT(facts.number("/direct_v2v/sent/packets"), 0);
  EXPECT_EQ(facts.number("/contacts"), 0);
  EXPECT_LT(facts.number("/pose/0"), 0.69) << "contact is at 0.7 m";
  facts_of(still);
}

Words patrol_on_a_line(const std::string& world, const std::string& name, const std::string& device,
                       const std::string& points, const std::string& speed, const Words& more = {}) {
  return with({"robot", world, "--name", name, "--port", std::to_string(free_ports(1)), "--controller", "patrol",
               "--set", points, "--set", speed, "--serial", device, "--json"},
              more);
}

/// A controller that uses only its pose, with the odometry of a simulated Create.
TEST(Robot, DrivesACreateOnASerialLine) {
  const Folder folder;
  const std::string world =
      folder.write("floor.world", "position( name \"create\" size [0.3 0.3 0.1] track 0.258 pose [0 0 0 90] )\n");
  CreateSimulator create;
  create.X.yaw = M_PI / 2;
  create.alone = false;
  Program robot(patrol_on_a_line(world, "create", create.device(), "points=0,0,0,0.2", "speed=0.4"));
  ASSERT_TRUE(create.streaming()) << robot.err();
  for (std::uint64_t steps = 1; create.X.y < 0.15 && steps < 300; ++steps) {
    create.run(7);
    ASSERT_TRUE(create.driven(steps)) << robot.err();
  }
  robot.signal(SIGINT);
  EXPECT_TRUE(create.reaches(CreateSimulator::passive));
  EXPECT_EQ(create.right, 0);
  const Outcome outcome = robot.wait();
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const Json facts(outcome.out);
  EXPECT_EQ(facts.text("/real_robot/type"), "create");
  EXPECT_GT(facts.number("/real_robot/frames"), 7);
  EXPECT_GT(facts.number("/real_robot/readings/cliff"), 7);
  EXPECT_DOUBLE_EQ(facts.number("/real_robot/reported/battery_V"), 15.7);
  EXPECT_NEAR(facts.number("/pose/1"), create.X.y, 0.05);
  EXPECT_NEAR(facts.number("/pose/0"), 0.0, 0.05);
}

/// Without a farm: it drives by the Create's own cliff sensors, and sets its outputs.
TEST(Robot, APythonControllerDrivesACreateByItsOwnSensors) {
  if (std::getenv("SENSORFARM_INSTRUMENTED") != nullptr) GTEST_SKIP() << "Python's plug-in is not instrumented";
  if (!std::filesystem::exists(SF_BINARY_DIR "/sensorfarm_python.so")) GTEST_SKIP() << "built without Python";
  const Folder folder;
  const std::string world =
      folder.write("floor.world", "position( name \"create\" size [0.3 0.3 0.1] track 0.258 laser() )\n");
  const std::string file = folder.write("lights.py",
                                        "class Lights:\n"
                                        "    def __init__(self, robot, settings):\n        pass\n"
                                        "    def step(self, input):\n        return 0, 0, 0\n"
                                        "    def sufficient_sensors(self):\n        return ['cliff']\n"
                                        "    def outputs(self):\n        return 0b001011\n");
  CreateSimulator create;
  create.alone = false;
  Program robot({"robot", world, "--name", "create", "--port", std::to_string(free_ports(1)), "--controller",
                 file + ":Lights", "--stop-after", "0.1", "--serial", create.device()});
  ASSERT_TRUE(create.streaming()) << robot.err();
  for (std::uint64_t steps = 1; create.outputs == 0 && steps < 300; ++steps) {
    create.run(7);
    ASSERT_TRUE(create.driven(steps)) << robot.err();
  }
  EXPECT_EQ(create.outputs, 0b011) << robot.err();
  EXPECT_EQ(create.low_side_drivers, 0b001);
  robot.signal(SIGINT);
  EXPECT_TRUE(create.reaches(CreateSimulator::passive));
  EXPECT_EQ(robot.wait().code, 1) << "the farm has never answered";
}

TEST(Robot, DrivesAKheperaOnASerialLine) {
  const Folder folder;
  const std::string world =
      folder.write("desk.world", "position( name \"khepera\" size [0.07 0.07 0.03] track 0.052 pose [0 0 0 90] )\n");
  KheperaEmulator khepera;
  khepera.X.yaw = M_PI / 2;
  khepera.alone = false;
  Program robot(patrol_on_a_line(world, "khepera", khepera.device(), "points=0,0,0,0.1", "speed=0.1",
                                 {"--robot-type", "khepera"}));
  while (khepera.X.y < 0.05 && khepera.lines < 3000) {
    ASSERT_TRUE(khepera.obey()) << robot.err();
  }
  robot.signal(SIGINT);
  EXPECT_TRUE(khepera.rests());
  const Outcome outcome = robot.wait();
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const Json facts(outcome.out);
  EXPECT_GT(facts.number("/real_robot/readings/infrared"), 3);
  EXPECT_NEAR(facts.number("/pose/1"), khepera.X.y, 0.03);
  EXPECT_NEAR(facts.number("/pose/0"), 0.0, 0.02);
}

TEST(Robot, DrivesAPioneerOnASerialLine) {
  const Folder folder;
  const std::string world = folder.write(
      "yard.world", "position( name \"pioneer\" size [0.6 0.5 0.3] drive \"skid\" track 0.394 pose [0 0 0 90] )\n");
  PioneerEmulator pioneer;
  pioneer.X.yaw = M_PI / 2;
  pioneer.alone = false;
  Program robot(patrol_on_a_line(world, "pioneer", pioneer.device(), "points=0,0,0,0.5", "speed=0.2",
                                 {"--robot-type", "pioneer"}));
  while (!pioneer.motors) {
    ASSERT_TRUE(pioneer.obey()) << robot.err();
  }
  for (int cycles = 0; pioneer.X.y < 0.3 && cycles < 300; ++cycles) {
    pioneer.run(1);
    ASSERT_TRUE(pioneer.driven(pioneer.turns + 1)) << robot.err();
  }
  robot.signal(SIGINT);
  EXPECT_TRUE(pioneer.closes());
  EXPECT_EQ(pioneer.vel, 0);
  const Outcome outcome = robot.wait();
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const Json facts(outcome.out);
  EXPECT_DOUBLE_EQ(facts.number("/real_robot/reported/battery_V"), 12.4);
  EXPECT_GT(facts.number("/real_robot/readings/sonar"), 3);
  EXPECT_NEAR(facts.number("/pose/1"), pioneer.X.y, 0.1);
  EXPECT_NEAR(facts.number("/pose/0"), 0.0, 0.05);
}

TEST(Robot, AStartForAnInvalidIdIsRejected) {
  EXPECT_EQ(run_program({"start", "--robot", "65536"}).code, 2);
  EXPECT_EQ(run_program({"start", "--server", "no.such.host.invalid"}).code, 2);
}

TEST_F(RobotsTest, ASilentFarmIsReportedOnce) {
  const Outcome outcome = silent->wait();
  EXPECT_EQ(outcome.code, 1) << outcome.err;
  EXPECT_EQ(count_lines(outcome.err), 2u) << outcome.err;
  EXPECT_NE(outcome.err.find("no packets from the farm at 127.0.0.1:"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.out.find("No packets from the farm"), std::string::npos) << outcome.out;
}

}  // namespace sf
