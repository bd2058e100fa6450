// The Create driver with a simulated Create, over a pseudo-terminal.

#include "server/create_drive.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <memory>

#include "base/error.h"
#include "sensors/bumper.h"
#include "sensors/cliff.h"
#include "sensors/irreceiver.h"
#include "tests/create_simulator.h"
#include "tests/refusal.h"

namespace sf::server {
namespace {

constexpr std::int64_t kTenth = 100'000'000;

struct CreateTest : testing::Test {
  CreateTest() : drive(make_real_robot({.device = create.device()}, base::Pose{1, 2, 0, 0.5}, 0.258)) {
    create.X = {1, 2, 0, 0.5};
    EXPECT_TRUE(create.streaming());
  }

  /// Slightly less than a tenth of a second.
  void step(const base::Twist& twist = {}, CreateSimulator::Bytes noise = {}) {
    create.run(3);
    if (!noise.empty()) create.send(noise);
    create.run(4);
    drive->update(now += kTenth);
    drive->drive(twist, now);
    EXPECT_TRUE(create.driven(create.drives + 1));
  }

  CreateSimulator create;
  std::unique_ptr<RealRobot> drive;
  std::int64_t now = 0;
};

TEST_F(CreateTest, DrivesAndTracksItsPose) {
  EXPECT_FALSE(drive->ready(0)) << "no frame yet";
  for (int k = 0; k < 50; ++k) step({0.3, 0, k < 25 ? 0.8 : -0.4});
  EXPECT_TRUE(drive->ready(now));
  create.run(7);
  drive->update(now += kTenth);
  EXPECT_EQ(create.mode, CreateSimulator::safe);
  const base::Pose& X = drive->state().X_WM;
  EXPECT_GT(std::hypot(create.X.x - 1, create.X.y - 2), 0.5) << "it moved";
  EXPECT_NEAR(X.x, create.X.x, 0.02) << "whole millimetres and degrees, without loss";
  EXPECT_NEAR(X.y, create.X.y, 0.02);
  EXPECT_NEAR(base::wrap_angle(X.yaw - create.X.yaw), 0.0, 0.02);
  EXPECT_NEAR(drive->state().velocity.forward, 0.3, 0.05);
  EXPECT_EQ(drive->counts().starts, 1u);
  EXPECT_EQ(drive->counts().skipped_bytes, 0u);
  EXPECT_EQ(create.unknown, 0u);
}

TEST(CreateDrive, CountsTheWheelsOfACreate2) {
  CreateSimulator create;
  create.left_counts = 65'000.0;  // both wrap
  create.right_counts = 65'500.0;
  const auto drive = make_real_robot({.type = "create2", .device = create.device()}, {}, 0.258);
  EXPECT_TRUE(create.streaming());
  std::int64_t now = 0;
  const auto steps = [&](int count, const base::Twist& twist) {
    for (int k = 0; k < count; ++k) {
      create.run(7);
      if (k % 10 == 5) create.frame(), create.run(1);  // the first of both is lost
      drive->update(now += kTenth);
      drive->drive(twist, now);
      EXPECT_TRUE(create.driven(create.drives + 1));
    }
  };
  const auto expect_true_pose = [&] {
    const base::Pose& X = drive->state().X_WM;
    EXPECT_NEAR(X.x, create.X.x, 0.003);
    EXPECT_NEAR(X.y, create.X.y, 0.003);
    EXPECT_NEAR(base::wrap_angle(X.yaw - create.X.yaw), 0.0, 0.005);
  };
  steps(40, {0.3, 0, 0.5});
  CreateSimulator::Bytes wrong = create.frame();
  wrong.back() ^= 1;
  create.send(wrong);  // its motion is in the next frame
  steps(40, {-0.2, 0, 0.5});
  create.run(1);
  drive->update(now += kTenth);
  expect_true_pose();
  EXPECT_EQ(drive->counts().wrong, 1u);
  EXPECT_EQ(create.unknown, 0u);
  const base::Pose before = drive->state().X_WM;
  create.restart();
  for (int k = 0; k < 6; ++k) drive->update(now += kTenth);
  EXPECT_TRUE(create.streaming());
  create.run(7);
  drive->update(now += kTenth);
  EXPECT_EQ(drive->counts().starts, 2u);
  EXPECT_NEAR(drive->state().X_WM.x, before.x, 0.001) << "the restart of its counters is no motion";
}

TEST_F(CreateTest, KeepsItsVelocityWithinOneInstant) {
  for (int k = 0; k < 10; ++k) step({0.3, 0, 0});
  const base::Twist before = drive->state().velocity;
  EXPECT_GT(before.forward, 0.0);
  drive->update(now);
  EXPECT_EQ(drive->state().velocity.forward, before.forward);
  EXPECT_EQ(drive->state().velocity.turn, before.turn);
}

TEST_F(CreateTest, ReportsAShortBump) {
  create.run(2);
  create.bumps = 2;
  create.run(1);
  create.bumps = 0;
  create.run(2);
  drive->update(now += kTenth);
  EXPECT_TRUE(drive->contact());
  step();
  EXPECT_FALSE(drive->contact());
}

TEST_F(CreateTest, ReportsItsOwnSensors) {
  create.cliffs = 0b0010;
  create.virtual_wall = create.wall = 1;
  create.infrared = 252;  // both buoys of a dock
  create.bumps = 2;       // left
  create.overcurrents = 0x10;
  create.buttons = 4;
  create.charging = 2;
  step();
  const auto values = [&](std::uint8_t type) {
    for (const OwnReading& own : drive->readings())
      if (own.type == type) return own.values;
    return std::vector<double>{};
  };
  EXPECT_EQ(values(sensors::kCliff), (std::vector<double>{0, 1, 0, 0}));
  EXPECT_EQ(values(sensors::kBumper), (std::vector<double>{1, 0}));
  EXPECT_EQ(values(sensors::kIrReceiver), (std::vector<double>{1, 252}));
  create.infrared = 130;  // of a remote control, not of a dock
  step();
  EXPECT_EQ(values(sensors::kIrReceiver), (std::vector<double>{1, 255}));
  std::map<std::string_view, double> facts;
  for (const RobotFact& fact : drive->facts()) facts[fact.name] = fact.value;
  EXPECT_DOUBLE_EQ(facts["battery_V"], 15.7);
  EXPECT_DOUBLE_EQ(facts["battery_A"], -0.24);
  EXPECT_EQ(facts["battery_C"], 24);
  EXPECT_DOUBLE_EQ(facts["charge_Ah"], 2.3);
  EXPECT_DOUBLE_EQ(facts["capacity_Ah"], 2.7);
  EXPECT_EQ(facts["charging"], 2);
  EXPECT_EQ(facts["left_wheel_overcurrent"], 1);
  EXPECT_EQ(facts["right_wheel_overcurrent"], 0);
  EXPECT_EQ(facts["wall"], 1);
  EXPECT_EQ(facts["buttons"], 4);
  EXPECT_EQ(facts["infrared_byte"], 130);
}

TEST_F(CreateTest, StopsWhileLiftedAndResumesWhenPutDown) {
  step({0.2, 0, 0});
  step({0.2, 0, 0});
  EXPECT_EQ(create.right, 200);
  create.drops = 1;
  step({0.2, 0, 0});
  EXPECT_EQ(drive->problem(now), "the Create is lifted");
  EXPECT_TRUE(drive->contact());
  EXPECT_EQ(create.right, 0);
  create.drops = 0;
  step({0.2, 0, 0});
  EXPECT_TRUE(create.reaches(CreateSimulator::safe));
  step({0.2, 0, 0});
  step({0.2, 0, 0});
  EXPECT_EQ(create.right, 200);
}

TEST_F(CreateTest, WaitsForPeopleAtACliff) {
  step();
  create.mode = CreateSimulator::passive;
  for (int k = 0; k < 20; ++k) step({0.2, 0, 0});
  EXPECT_NE(drive->problem(now).find("at a cliff"), std::string::npos);
  EXPECT_EQ(create.mode, CreateSimulator::passive) << "else it would creep over the edge";
}

TEST_F(CreateTest, DropsDamagedFrames) {
  step();
  CreateSimulator::Bytes wrong = create.frame(), cut = create.frame();
  wrong.back() ^= 1;
  cut.erase(cut.begin() + 6);
  step({}, wrong);
  step({}, cut);
  step({}, {'s', 'l', 'e', 'e', 'p', 19, 19});
  EXPECT_TRUE(drive->ready(now));
  EXPECT_GE(drive->counts().wrong, 1u) << "a frame that lost a byte may look like one, too";
  EXPECT_EQ(drive->counts().frames, 4 * 7u);
  EXPECT_EQ(drive->counts().skipped_bytes, 2 * wrong.size() - 1 + 7u);
}

TEST_F(CreateTest, RestartsARobotAfterAPowerCycle) {
  step();
  create.restart();
  for (int k = 0; k < 5; ++k) drive->update(now += kTenth);
  EXPECT_TRUE(drive->ready(now)) << "half a second";
  drive->update(now += kTenth);
  EXPECT_NE(drive->problem(now).find("is silent"), std::string::npos);
  EXPECT_TRUE(create.streaming());
  EXPECT_EQ(create.mode, CreateSimulator::safe);
  EXPECT_EQ(drive->counts().starts, 2u);
  for (int k = 0; k < 9; ++k) drive->update(now += kTenth);
  EXPECT_EQ(drive->counts().starts, 2u) << "once a second";
  step({0.1, 0, 0});
  EXPECT_TRUE(drive->ready(now));
}

TEST_F(CreateTest, DiscardsAFrameCutByAPowerCycle) {
  step();
  CreateSimulator::Bytes cut = create.frame();
  cut.resize(6);
  create.send(cut);
  create.restart();
  for (int k = 0; k < 6; ++k) drive->update(now += kTenth);
  EXPECT_TRUE(create.streaming());
  step();
  EXPECT_EQ(drive->counts().starts, 2u);
  EXPECT_EQ(drive->counts().frames, 2 * 7u);
  EXPECT_EQ(drive->counts().skipped_bytes, 0u);
}

TEST(CreateDrive, ReopensALineThatHungUp) {
  const std::filesystem::path name = std::filesystem::path(testing::TempDir()) / ("create-" + std::to_string(getpid()));
  auto create = std::make_unique<CreateSimulator>();
  std::filesystem::create_symlink(create->device(), name);
  const auto drive = make_real_robot({.device = name.string()}, {}, 0.258);
  EXPECT_TRUE(create->streaming());
  create->hang_up();
  drive->update(kTenth);
  EXPECT_NE(drive->problem(kTenth).find("was disconnected"), std::string::npos);
  drive->drive({0.1, 0, 0}, kTenth);
  std::filesystem::remove(name);
  for (int k = 2; k < 30; ++k) drive->update(k * kTenth);
  EXPECT_EQ(drive->counts().lines, 1u) << "it is unplugged still";
  create = std::make_unique<CreateSimulator>();
  std::filesystem::create_symlink(create->device(), name);
  drive->update(40 * kTenth);
  EXPECT_TRUE(create->streaming());
  EXPECT_EQ(drive->counts().lines, 2u);
  create->run(7);
  drive->update(41 * kTenth);
  EXPECT_TRUE(drive->ready(41 * kTenth));
  std::filesystem::remove(name);
}

TEST_F(CreateTest, StopsTheRobotOnDestruction) {
  step({0.2, 0, 0});
  step({0.2, 0, 0});
  EXPECT_EQ(create.right, 200);
  drive.reset();
  EXPECT_TRUE(create.reaches(CreateSimulator::passive));
  EXPECT_EQ(create.right, 0);
  EXPECT_TRUE(create.streams.empty());
}

std::string line_refusal(const std::string& device, unsigned baud = 57600) {
  return refusal_of([&] { make_real_robot({.device = device, .baud = baud}, {}, 0.258); });
}

TEST(CreateDrive, RejectsAFileThatIsNotASerialLine) {
  EXPECT_NE(line_refusal("/dev/ttyNONE0").find("`ls /dev/ttyUSB*"), std::string::npos);
  EXPECT_NE(line_refusal("/dev/null").find("is not a serial line"), std::string::npos);
  CreateSimulator create;
  EXPECT_NE(line_refusal(create.device(), 12345).find("expected 9600"), std::string::npos);
}

}  // namespace
}  // namespace sf::server
