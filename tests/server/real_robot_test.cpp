// Real robots within a robot's process: their own sensors, contacts and odometry.

#include "server/real_robot.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "control/controllers.h"
#include "sensors/analog.h"
#include "sensors/battery.h"
#include "sensors/bumper.h"
#include "sensors/cliff.h"
#include "sensors/irreceiver.h"
#include "sensors/laser.h"
#include "sensors/sonar.h"
#include "tests/create_simulator.h"
#include "tests/pioneer_emulator.h"
#include "tests/refusal.h"
#include "tests/server/fixture.h"

namespace sf::server {
namespace {

/// Inputs of the last step of the controller below.
struct Seen {
  std::map<std::uint8_t, std::vector<double>> values;
  std::map<std::uint8_t, base::Pose> poses;
  std::map<std::uint8_t, std::uint32_t> numbers;
  base::Pose X_WM;
  bool contact = false;
  std::uint8_t outputs = 0;  ///< that it sets
};
Seen& seen() {
  static Seen last;
  return last;
}

class Recorder : public control::Controller {
 public:
  base::Twist step(const control::ControllerInput& input) override {
    seen() = {.X_WM = input.state.X_WM, .contact = input.contact, .outputs = seen().outputs};
    for (const base::ReadingBlock& reading : input.readings) {
      seen().values[reading.type] = {reading.values.begin(), reading.values.end()};
      seen().poses[reading.type] = reading.X_WS;
      seen().numbers[reading.type] = reading.sensor;
    }
    return {0.2, 0.0, 0.0};
  }
  std::uint8_t outputs() const override { return seen().outputs; }
};

constinit const control::ControllerType recorder{
    .name = "test-recorder",
    .summary = "records its input",
    .stops_on_bumper = false,
    .make = [](const control::ControllerContext&, control::Settings&) -> std::unique_ptr<control::Controller> {
      return std::make_unique<Recorder>();
    }};

/// The same, by infrared receivers or lasers alone.
struct OwnRecorder final : Recorder {
  std::uint64_t needs() const override { return 1u << sensors::kIrReceiver | 1u << sensors::kLaser; }
};

constinit const control::ControllerType own_recorder{
    .name = "test-own-recorder",
    .summary = recorder.summary,
    .stops_on_bumper = false,
    .make = [](const control::ControllerContext&, control::Settings&) -> std::unique_ptr<control::Controller> {
      return std::make_unique<OwnRecorder>();
    }};

struct RealRobotTest : testing::Test {
  static void SetUpTestSuite() {
    control::add_controller(&recorder);
    control::add_controller(&own_recorder);
  }
  RobotClientOptions options(const RealRobotOptions& serial, std::string_view controller, double stop_after) const {
    RobotClientOptions options{.stop_after = stop_after, .log_descriptor = f.log.descriptor()};
    options.link.farm = {netio::kLoopback, f.service->port()};
    options.controller.name = controller;
    options.real = serial;
    return options;
  }
  std::unique_ptr<RobotClient> client(const RealRobotOptions& serial, std::string_view controller = recorder.name,
                                      double stop_after = 0.0) {
    return std::make_unique<RobotClient>(f.world, f.sensor_set, 1, f.layout, options(serial, controller, stop_after));
  }
  /// The fixture's layout with the ports of another sensor type.
  StreamLayout layout_with(std::uint8_t type) const {
    StreamLayout layout = f.layout;
    layout.bases[type] = layout.bases.at(sensors::kLaser) + 2 * layout.stride;
    return layout;
  }
  Fixture f;
};

TEST_F(RealRobotTest, OwnReadingsOfACreateReachItsController) {
  CreateSimulator create;
  const auto robot = client({.device = create.device()});
  EXPECT_TRUE(create.streaming());
  create.cliffs = 0b1000;
  create.infrared = 244;
  create.wall = 1;
  create.buttons = 4;          // Advance
  create.overcurrents = 0x10;  // left wheel
  create.charging = 2;         // full
  create.voltage = 15'700;
  create.current = 1'200;
  create.charge = 2'100;
  std::int64_t now = 0;
  for (std::uint64_t k = 1; k <= 10; ++k) {
    create.run(7);
    robot->step(now += kTick);
    EXPECT_TRUE(create.driven(k));
  }
  EXPECT_EQ(create.right, 200);
  EXPECT_EQ(seen().values[sensors::kCliff], (std::vector<double>{0, 0, 0, 1}));
  EXPECT_EQ(seen().values[sensors::kIrReceiver], (std::vector<double>{0, 244}));
  EXPECT_EQ(seen().values[sensors::kBumper], (std::vector<double>{0, 0}));
  const std::vector<double>& inputs = seen().values[sensors::kAnalog];
  ASSERT_EQ(inputs.size(), 20u);
  EXPECT_EQ(std::vector<double>(inputs.begin() + 10, inputs.end()), (std::vector<double>{5, 1, 0, 0, 5, 1, 5, 1, 0, 0}))
      << "wall, Play, Advance, overcurrent left and right";
  EXPECT_EQ(seen().values[sensors::kBattery], (std::vector<double>{1e-3 * 15'700, 1e-3 * 1'200, 1e-3 * 2'100, 1}));
  EXPECT_GT(seen().X_WM.x, 2.1) << "it moved";
  EXPECT_EQ(seen().poses[sensors::kCliff].x, seen().X_WM.x);
  EXPECT_EQ(seen().numbers[sensors::kCliff], 0u) << "it has no virtual sensor of this type";
  EXPECT_FALSE(seen().contact);
  const RobotClientStats stats = robot->stats();
  ASSERT_TRUE(stats.real);
  EXPECT_EQ(stats.real->type, "create");
  EXPECT_EQ(stats.real->counts.frames, 70u);
  EXPECT_EQ(stats.real->readings.at("cliff"), 70u);
  EXPECT_EQ(stats.real->facts[0].name, "battery_V");
}

TEST_F(RealRobotTest, PinsOfACargoBayAreReadAndSet) {
  CreateSimulator create;
  create.analog = 1023;
  create.inputs = 0b0101;
  seen().outputs = 0;
  auto robot = client({.device = create.device()});
  EXPECT_TRUE(create.streaming());
  std::int64_t now = 0;
  const auto step = [&](std::uint8_t outputs, std::uint64_t drives) {
    seen().outputs = outputs;
    create.run(7);
    robot->step(now += kTick);
    EXPECT_TRUE(create.driven(drives));
  };
  step(0, 1);
  EXPECT_EQ(seen().values[sensors::kAnalog],
            (std::vector<double>{5, 1023, 5, 1, 0, 0, 5, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}));
  for (std::uint64_t k = 2; k <= 4; ++k) step(0b101011, k);
  EXPECT_EQ(create.outputs, 0b011);
  EXPECT_EQ(create.low_side_drivers, 0b101);
  robot->leave(now);
  EXPECT_TRUE(create.reaches(CreateSimulator::passive));
  EXPECT_EQ(create.outputs + create.low_side_drivers, 0) << "cleared at the end";
  EXPECT_EQ(create.unknown, 0u);
  seen().outputs = 0;
}

TEST_F(RealRobotTest, OutputsThatARobotDoesNotHaveAreReported) {
  CreateSimulator create;
  seen().outputs = 1;
  const auto robot = client({.type = "create2", .device = create.device()});
  EXPECT_TRUE(create.streaming());
  create.run(7);
  robot->step(kTick);
  EXPECT_TRUE(create.driven(1));
  EXPECT_EQ(create.outputs, 0);
  EXPECT_EQ(seen().values[sensors::kAnalog], std::vector<double>(10, 0.0)) << "no cargo bay";
  EXPECT_NE(f.log.read_all().find("has no digital outputs"), std::string::npos);
  seen().outputs = 0;
}

TEST_F(RealRobotTest, OwnSensorsAreNumberedAfterVirtualOnes) {
  world::World world = f.world;
  world.movers[1].sensors.push_back({.type = "bumper"});
  const sensors::SensorSet sensor_set(world);
  StreamLayout layout = f.layout;
  layout.bases[sensors::kBumper] = layout.bases.at(sensors::kLaser) + 2 * layout.stride;
  CreateSimulator create;
  RobotClientOptions options{.stop_after = 0.0, .log_descriptor = f.log.descriptor()};
  options.link.farm = {netio::kLoopback, f.service->port()};
  options.controller.name = recorder.name;
  options.real = RealRobotOptions{.device = create.device()};
  RobotClient robot(world, sensor_set, 1, layout, options);
  EXPECT_TRUE(create.streaming());
  create.run(7);
  robot.step(kTick);
  EXPECT_EQ(seen().numbers[sensors::kBumper], 1u);
  EXPECT_EQ(seen().numbers[sensors::kCliff], 0u);
}

/// The farm is away, and with it the robot's virtual laser. The controller whose needs the real robot's own receiver
/// meets continues, without virtual readings; the other one stops.
TEST_F(RealRobotTest, OwnSensorsThatSufficeReplaceTheFarm) {
  for (const auto& [controller, continues] : {std::pair{recorder.name, false}, {own_recorder.name, true}}) {
    CreateSimulator create;
    const auto robot = client({.device = create.device()}, controller, 0.5);
    EXPECT_TRUE(create.streaming());
    std::int64_t now = 0;
    for (std::uint64_t k = 1; k <= 20; ++k) {
      create.run(7);
      robot->step(now += kTick);
      EXPECT_TRUE(create.driven(k));
    }
    EXPECT_EQ(create.right, continues ? 200 : 0) << controller;
    EXPECT_EQ(seen().values.count(sensors::kLaser), 0u);
  }
}

/// `wander` of a robot without lasers needs only its bumper, although its virtual one is missing, too; with a laser, it
/// waits for scans.
TEST_F(RealRobotTest, WandersByItsOwnBumperWithoutTheFarm) {
  for (const bool laser : {true, false}) {
    world::World world = f.world;
    if (!laser) world.movers[1].sensors = {{.type = "bumper"}};
    const sensors::SensorSet sensor_set(world);
    const StreamLayout layout = layout_with(sensors::kBumper);
    CreateSimulator create;
    RobotClient robot(world, sensor_set, 1, layout, options({.device = create.device()}, "wander", 0.5));
    EXPECT_TRUE(create.streaming());
    std::int64_t now = 0;
    bool backed_off = false;
    for (std::uint64_t k = 1; k <= 26; ++k) {
      create.bumps = k == 20 || k == 21 ? 3 : 0;
      create.run(7);
      robot.step(now += kTick);
      EXPECT_TRUE(create.driven(k));
      backed_off = backed_off || create.left + create.right < 0;
      if (k == 19) {
        EXPECT_EQ(create.left + create.right > 0, !laser);
      }
    }
    EXPECT_EQ(backed_off, !laser) << "from what it touched";
  }
}

world::Sensor front_sonar() {
  world::Sensor sonar{.type = "sonar", .settings = {{.key = "scount", .numbers = {4.0}}}};
  for (const auto& [key, degrees] :
       {std::pair{"spose[0]", 90.0}, {"spose[1]", 50.0}, {"spose[2]", 30.0}, {"spose[3]", 10.0}})
    sonar.settings.push_back({.key = key, .numbers = {0.2, 0.0, degrees * M_PI / 180.0}});
  return sonar;
}

/// A real Pioneer avoids obstacles by its own sonar while the farm, and with it the laser, is away: it needs the
/// sonar's mounting from the world file.
TEST_F(RealRobotTest, AvoidsByItsOwnSonarWithoutTheFarm) {
  for (const bool mounted : {false, true}) {
    world::World world = f.world;
    if (mounted) world.movers[1].sensors.push_back(front_sonar());
    const sensors::SensorSet sensor_set(world);
    const StreamLayout layout = layout_with(sensors::kSonar);
    PioneerEmulator pioneer;
    RobotClient robot(world, sensor_set, 1, layout,
                      options({.type = "pioneer", .device = pioneer.device()}, "avoid", 0.5));
    std::int64_t now = 0;
    const auto steps = [&](int count) {
      for (int k = 0; k < count; ++k) {
        pioneer.run(1);
        robot.step(now += kTick);
        EXPECT_TRUE(pioneer.driven(pioneer.turns + 1));
      }
    };
    for (int k = 0; k < 20 && !pioneer.motors; ++k) {
      EXPECT_TRUE(pioneer.obey());
      robot.move(now += 10 * kMs);
    }
    pioneer.ranges[3] = 5000;
    steps(600);
    EXPECT_EQ(pioneer.vel > 0, mounted) << "nothing ahead; without cameras, it goes on when it is no longer sure where";
    pioneer.ranges[3] = 150;
    steps(10);
    EXPECT_EQ(pioneer.vel, 0);
    EXPECT_EQ(pioneer.rvel != 0, mounted) << "an obstacle ahead";
  }
}

TEST_F(RealRobotTest, AContactBetweenTwoStepsReachesTheController) {
  PioneerEmulator pioneer;
  const auto robot = client({.type = "pioneer", .device = pioneer.device()});
  std::int64_t now = 0;
  for (int k = 0; k < 20 && !pioneer.motors; ++k) {
    EXPECT_TRUE(pioneer.obey());
    robot->move(now += 10 * kMs);
  }
  const auto cycle = [&](std::uint8_t front) {
    pioneer.front = front;
    pioneer.run(1);
    robot->move(now += kTick);
  };
  cycle(0);
  cycle(2);
  cycle(0);
  robot->step(now);
  EXPECT_TRUE(seen().contact);
  cycle(0);
  robot->step(now);
  EXPECT_FALSE(seen().contact);
  EXPECT_EQ(robot->stats().contacts, 1u);
  EXPECT_TRUE(pioneer.driven(2));
  EXPECT_EQ(pioneer.vel, 200);
}

TEST(RealRobot, TypesAreFoundByTheirWords) {
  for (const RealRobotType& type : real_robot_types()) EXPECT_EQ(&real_robot_type(type.word), &type);
  expect_in("did you mean 'khepera'?", refusal_of([] { real_robot_type("kepera"); }));
}

TEST(RealRobot, EachSerialTypeHasItsLine) {
  for (const RealRobotType& type : real_robot_types()) {
    if (type.behind_server || type.emulated) continue;
    PseudoTerminal terminal;
    const auto robot = make_real_robot({.type = std::string(type.word), .device = terminal.device()}, {}, 0.1);
    expect_in(fmt::format("at {} baud", type.baud), robot->problem(kSecond));
    EXPECT_EQ(terminal.stop_bits(), type.stop_bits) << type.word;
    EXPECT_EQ(robot->due() == INT64_MAX, type.poll == 0) << type.word;
  }
}

}  // namespace
}  // namespace sf::server
