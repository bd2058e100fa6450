// The Pioneer driver with an emulated Pioneer 3-AT, over a pseudo-terminal.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <memory>

#include "sensors/battery.h"
#include "sensors/bumper.h"
#include "sensors/sonar.h"
#include "server/real_robot.h"
#include "tests/pioneer_emulator.h"
#include "tests/server/own_values.h"
#include "tests/units.h"

namespace sf::server {
namespace {

std::unique_ptr<RealRobot> open_pioneer(const std::string& device, const base::Pose& X_WM = {}) {
  return make_real_robot({.type = "pioneer", .device = device}, X_WM, 0.394);
}

struct PioneerTest : testing::Test {
  PioneerTest() : drive(open_pioneer(pioneer.device(), {1, 2, 0, 0.5})) { pioneer.X = {1, 2, 0, 0.5}; }

  void wait(std::int64_t time) { drive->update(now += time); }
  /// Until its motors are on.
  void connect() {
    for (int k = 0; k < 20 && !pioneer.motors; ++k) {
      EXPECT_TRUE(pioneer.obey());
      wait(10 * kMs);
    }
    EXPECT_TRUE(pioneer.motors);
    pioneer.run(1);
    wait(90 * kMs);
  }
  void step(const base::Twist& twist, const PioneerEmulator::Bytes& noise = {}) {
    drive->drive(twist, now);
    EXPECT_TRUE(pioneer.driven(pioneer.turns + 1));
    if (!noise.empty()) pioneer.send(noise);
    pioneer.run(1);
    wait(kTick);
  }
  void expect_true_pose(double within) const {
    const base::Pose& X = drive->state().X_WM;
    EXPECT_NEAR(X.x, pioneer.X.x, within);
    EXPECT_NEAR(X.y, pioneer.X.y, within);
    EXPECT_NEAR(base::wrap_angle(X.yaw - pioneer.X.yaw), 0.0, within);
  }
  std::vector<double> values(std::uint8_t type) const { return own_values(*drive, type); }

  PioneerEmulator pioneer;
  std::unique_ptr<RealRobot> drive;
  std::int64_t now = 0;
};

TEST_F(PioneerTest, DrivesAndTracksItsPose) {
  EXPECT_FALSE(drive->ready(0)) << "not synchronized yet";
  connect();
  EXPECT_TRUE(drive->ready(now)) << drive->problem(now);
  for (int k = 0; k < 200; ++k) step({0.5, 0, k % 80 < 40 ? 0.4 : -0.3});
  EXPECT_GT(std::hypot(pioneer.X.x - 1, pioneer.X.y - 2), 1.0) << "it moved";
  expect_true_pose(0.01);
  EXPECT_NEAR(drive->state().velocity.forward, 0.5, 0.02);
  EXPECT_EQ(pioneer.vel, 500);
  EXPECT_EQ(pioneer.unknown + pioneer.wrong, 0u);
  EXPECT_EQ(drive->counts().wrong + drive->counts().skipped_bytes, 0u);
  EXPECT_EQ(drive->counts().starts, 1u);
}

TEST_F(PioneerTest, ScalesThePositionsOfOlderControllers) {
  pioneer.subtype = "P3AT";
  pioneer.unit = 0.465;
  connect();
  for (int k = 0; k < 30; ++k) step({0.5, 0, 0.2});
  expect_true_pose(0.01);
}

TEST_F(PioneerTest, UnwrapsCounters) {
  connect();
  pioneer.x = 32'600.0;
  pioneer.y = -100.0;
  pioneer.heading = M_PI - 0.1;
  pioneer.run(1);
  wait(kTick);
  const base::Pose before = drive->state().X_WM;
  for (int k = 0; k < 20; ++k) step({0.5, 0, 0.2});
  for (int k = 0; k < 20; ++k) step({-0.5, 0, -0.2});
  EXPECT_NEAR(drive->state().X_WM.x, before.x, 0.01);
  EXPECT_NEAR(drive->state().X_WM.y, before.y, 0.01);
  EXPECT_NEAR(base::wrap_angle(drive->state().X_WM.yaw - before.yaw), 0.0, 0.01);
}

TEST_F(PioneerTest, ReportsItsSensors) {
  connect();
  pioneer.ranges[3] = 1234;
  pioneer.ranges[12] = 5000;
  pioneer.front = 1u << 1;  // leftmost
  pioneer.rear = 1u << 1;   // rightmost: they run clockwise
  step({});
  const std::vector<double> ranges = values(sensors::kSonar);
  ASSERT_EQ(ranges.size(), 16u);
  EXPECT_DOUBLE_EQ(ranges[3], 1.234);
  EXPECT_EQ(ranges[12], 5.0);
  EXPECT_EQ(ranges[0], 5.0) << "nothing received yet";
  EXPECT_EQ(values(sensors::kBumper), (std::vector<double>{1, 0, 0, 0, 0, 0, 0, 0, 0, 1}));
  const std::vector<double> battery = values(sensors::kBattery);
  ASSERT_EQ(battery.size(), 4u);
  EXPECT_DOUBLE_EQ(battery[0], 12.4);
  EXPECT_TRUE(std::isnan(battery[1]) && std::isnan(battery[2]) && std::isnan(battery[3])) << "not reported";
  EXPECT_TRUE(drive->contact());
  pioneer.front = pioneer.rear = 0;
  step({});
  EXPECT_FALSE(drive->contact());
  pioneer.rear = 1;  // left wheel
  step({});
  EXPECT_TRUE(drive->contact()) << "a stall";
  ASSERT_FALSE(drive->facts().empty());
  EXPECT_EQ(drive->facts()[0].name, "battery_V");
  EXPECT_DOUBLE_EQ(drive->facts()[0].value, 12.4);
}

TEST_F(PioneerTest, LosesNoMotionToDamagedPackets) {
  connect();
  for (int k = 0; k < 40; ++k) {
    PioneerEmulator::Bytes damaged = pioneer.sip();
    switch (k % 5) {
      case 0:
        damaged[10] ^= 0x10;
        break;  // a wrong checksum
      case 1:
        damaged.erase(damaged.begin() + 7);
        break;  // a lost byte
      case 2:
        damaged.resize(9);
        break;  // cut
      case 3:
        damaged = {0xFA, 0xFB, 200};
        break;  // an invalid length: hides the packets that follow
      default:
        damaged = {0xFA, 0xFA, 0xFB, 2, 'x'};  // garbage
    }
    step({0.3, 0, 0.3}, damaged);
  }
  for (int k = 0; k < 6; ++k) step({});
  EXPECT_TRUE(drive->ready(now)) << drive->problem(now);
  EXPECT_GT(drive->counts().wrong, 10u);
  EXPECT_GT(drive->counts().skipped_bytes, 100u);
  EXPECT_EQ(drive->counts().starts, 1u);
  expect_true_pose(0.01);
}

TEST_F(PioneerTest, RepeatsALostHandshake) {
  pioneer.lose = 3;  // CLOSE, SYNC0, and one more
  EXPECT_TRUE(pioneer.obey(2));
  for (int k = 0; k < 6; ++k) wait(kTick);
  EXPECT_EQ(drive->counts().starts, 2u);
  connect();
  EXPECT_TRUE(drive->ready(now)) << drive->problem(now);
}

TEST_F(PioneerTest, RepeatsALostEnable) {
  for (int k = 0; k < 20 && !pioneer.open; ++k) {
    EXPECT_TRUE(pioneer.obey());
    wait(10 * kMs);
  }
  pioneer.lose = 2;
  EXPECT_TRUE(pioneer.obey(2));
  for (int k = 0; k < 12; ++k) {
    pioneer.run(1);
    wait(kTick);
  }
  EXPECT_NE(drive->problem(now).find("MOTORS button"), std::string::npos);
  connect();
  EXPECT_TRUE(drive->ready(now)) << drive->problem(now);
}

TEST_F(PioneerTest, ClosesTheSessionOfAnEarlierProgram) {
  connect();
  step({0.2, 0, 0});
  const auto second = open_pioneer(pioneer.device());
  EXPECT_TRUE(pioneer.closes());
  EXPECT_EQ(pioneer.vel, 0);
}

TEST_F(PioneerTest, IsStartedAgainAfterAReset) {
  connect();
  for (int k = 0; k < 20; ++k) step({0.5, 0, 0});
  pioneer.restart();
  const base::Pose before = drive->state().X_WM;
  for (int k = 0; k < 6; ++k) wait(kTick);
  EXPECT_NE(drive->problem(now).find("is silent"), std::string::npos);
  connect();
  EXPECT_TRUE(drive->ready(now)) << drive->problem(now);
  EXPECT_EQ(drive->counts().starts, 2u);
  EXPECT_NEAR(drive->state().X_WM.x, before.x, 0.01) << "the restart of its odometry is no motion";
  step({0.5, 0, 0});
  EXPECT_EQ(pioneer.vel, 500);
}

TEST_F(PioneerTest, StopsWhileItsStopButtonIsPressed) {
  connect();
  step({0.5, 0, 0});
  pioneer.stop_button = true;
  step({0.5, 0, 0});
  EXPECT_NE(drive->problem(now).find("stop button"), std::string::npos);
  pioneer.motors = pioneer.stop_button = false;
  for (int k = 0; k < 20; ++k) step({0.5, 0, 0});
  EXPECT_NE(drive->problem(now).find("MOTORS button"), std::string::npos);
  EXPECT_FALSE(pioneer.motors) << "people switched them off";
  pioneer.motors = true;
  step({0.5, 0, 0}), step({0.5, 0, 0});
  EXPECT_EQ(pioneer.vel, 500);
}

TEST_F(PioneerTest, KeepsTheWatchdogFromExpiring) {
  connect();
  step({0.2, 0, 0});
  for (int k = 0; k < 40; ++k) {  // a slow controller
    pioneer.run(1);
    wait(kTick);
    if (k % 5 == 4) {
      EXPECT_TRUE(pioneer.obey());
    }
  }
  EXPECT_GE(pioneer.pulses, 6u);
  EXPECT_EQ(pioneer.watchdog_stops, 0u);
  EXPECT_EQ(pioneer.vel, 200);
}

TEST_F(PioneerTest, EndsTheSessionOnDestruction) {
  connect();
  step({0.5, 0, 0});
  drive.reset();
  EXPECT_TRUE(pioneer.closes());
  EXPECT_EQ(pioneer.vel, 0);
}

TEST(PioneerDrive, ReopensALineThatHungUp) {
  const std::filesystem::path name =
      std::filesystem::path(testing::TempDir()) / ("pioneer-" + std::to_string(getpid()));
  auto pioneer = std::make_unique<PioneerEmulator>();
  std::filesystem::create_symlink(pioneer->device(), name);
  const auto drive = open_pioneer(name.string());
  pioneer->hang_up();
  drive->update(kTick);
  EXPECT_NE(drive->problem(kTick).find("was disconnected"), std::string::npos);
  drive->drive({0.1, 0, 0}, kTick);
  std::filesystem::remove(name);
  for (int k = 2; k < 30; ++k) drive->update(k * kTick);
  EXPECT_EQ(drive->counts().lines, 1u) << "it is unplugged still";
  pioneer = std::make_unique<PioneerEmulator>();
  std::filesystem::create_symlink(pioneer->device(), name);
  std::int64_t now = 4 * kSecond;
  drive->update(now);
  for (int k = 0; k < 20 && !pioneer->motors; ++k) {
    EXPECT_TRUE(pioneer->obey());
    drive->update(now += 10 * kMs);
  }
  pioneer->run(1);
  drive->update(now += 10 * kMs);
  EXPECT_TRUE(drive->ready(now)) << drive->problem(now);
  EXPECT_EQ(drive->counts().lines, 2u);
  std::filesystem::remove(name);
}

}  // namespace
}  // namespace sf::server
