// The Khepera driver with an emulated Khepera II, over a pseudo-terminal.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <memory>

#include "sensors/infrared.h"
#include "sensors/lightsensor.h"
#include "server/real_robot.h"
#include "tests/khepera_emulator.h"
#include "tests/units.h"

namespace sf::server {
namespace {

std::unique_ptr<RealRobot> open_khepera(const std::string& device, const base::Pose& X_WM = {}) {
  return make_real_robot({.type = "khepera", .device = device}, X_WM, KheperaEmulator::kTrack);
}

struct KheperaTest : testing::Test {
  KheperaTest() : drive(open_khepera(khepera.device(), {1, 2, 0, 0.5})) {
    khepera.X = {1, 2, 0, 0.5};
    wait(60 * kMs);  // until the line is clear
    exchange();
  }
  void wait(std::int64_t time) { drive->update(now += time); }
  /// The robot answers `count` requests.
  void exchange(int count = 1) {
    for (int k = 0; k < count; ++k) {
      EXPECT_TRUE(khepera.obey());
      wait(20 * kMs);
    }
  }
  /// A tenth of a second.
  void step(const base::Twist& twist) {
    drive->drive(twist, now);
    exchange(5);
  }
  void expect_true_pose(double within) const {
    const base::Pose& X = drive->state().X_WM;
    EXPECT_NEAR(X.x, khepera.X.x, within);
    EXPECT_NEAR(X.y, khepera.X.y, within);
    EXPECT_NEAR(base::wrap_angle(X.yaw - khepera.X.yaw), 0.0, within / 0.05);
  }

  KheperaEmulator khepera;
  std::unique_ptr<RealRobot> drive;
  std::int64_t now = 0;
};

TEST_F(KheperaTest, DrivesAndTracksItsPose) {
  for (int k = 0; k < 60; ++k) step({0.1, 0, k < 30 ? 1.0 : -0.5});
  EXPECT_TRUE(drive->ready(now));
  EXPECT_GT(std::hypot(khepera.X.x - 1, khepera.X.y - 2), 0.2) << "it moved";
  EXPECT_NEAR(drive->state().velocity.forward, 0.1, 0.01);
  step({});
  step({});
  expect_true_pose(1e-3);
  EXPECT_EQ(khepera.wrong, 0u);
  EXPECT_EQ(drive->counts().wrong, 0u);
  EXPECT_EQ(drive->counts().timeouts, 0u);
  EXPECT_EQ(drive->counts().starts, 1u);
}

TEST_F(KheperaTest, ReportsItsSensors) {
  exchange(8);
  ASSERT_EQ(drive->readings().size(), 2u);
  const OwnReading& own = drive->readings()[0];
  EXPECT_EQ(own.type, sensors::kInfrared);
  ASSERT_EQ(own.values.size(), 16u);
  EXPECT_NEAR(own.values[4], 0.05 * (1.0 - 100.0 / 1023.0), 1e-12) << "the range of the third";
  EXPECT_EQ(own.values[5], 100.0);
  EXPECT_EQ(own.values[6], 0.0) << "touched";
  EXPECT_EQ(own.values[14], 0.05 * (1.0 - 50.0 / 1023.0));
  ASSERT_EQ(drive->facts().size(), 8u);
  EXPECT_EQ(drive->facts()[3].value, 50.0);
  const OwnReading& light = drive->readings()[1];
  EXPECT_EQ(light.type, sensors::kLightSensor);
  ASSERT_EQ(light.values.size(), 16u);
  EXPECT_EQ(light.values[7], 50.0);
  EXPECT_NEAR(light.values[6], 1000.0 * (1.0 - 50.0 / 450.0), 1e-9);
  EXPECT_FALSE(drive->contact());
}

TEST_F(KheperaTest, SurvivesDamagedAnswers) {
  int answers = 0;
  // Each tenth answer lost, or damaged in turn: without its end, without a comma, with another letter.
  khepera.damage = [&](std::string line) {
    if (++answers % 10 != 0) return line;
    switch (answers / 10 % 4) {
      case 0:
        return std::string();
      case 1:
        return line.substr(0, line.size() - 2);
      case 2:
        return std::string("x") + line.substr(1);
      default:
        return line.insert(1, "%");
    }
  };
  for (int k = 0; k < 50; ++k) {
    drive->drive({0.08, 0, 0.3}, now);
    for (int j = 0; j < 5; ++j) {
      const std::uint64_t asked = khepera.lines;
      EXPECT_TRUE(khepera.obey());
      wait(20 * kMs);
      // Without a valid answer, the driver clears the line and asks again.
      if (answers % 10 == 0 && khepera.lines > asked) wait(150 * kMs), wait(60 * kMs);
    }
  }
  khepera.damage = {};
  step({});
  step({});
  EXPECT_TRUE(drive->ready(now));
  EXPECT_GT(drive->counts().timeouts, 3u);
  EXPECT_GT(drive->counts().wrong, 3u);
  EXPECT_EQ(drive->counts().starts, 1u) << "single faults are no reason to start again";
  EXPECT_EQ(khepera.wrong, 0u);
  expect_true_pose(1e-3);
}

TEST_F(KheperaTest, CorrectsADamagedCounterByTheNext) {
  for (int k = 0; k < 20; ++k) step({0.1, 0, 0});
  bool damaged = false;
  khepera.damage = [&](std::string line) {
    if (damaged || line[0] != 'h') return line;
    damaged = true;
    return line.insert(2, "9");  // one digit more
  };
  for (int k = 0; k < 10; ++k) {
    step({0.1, 0, 0});
    EXPECT_NEAR(drive->state().X_WM.x, khepera.X.x, 0.03) << k;
  }
  EXPECT_TRUE(damaged);
  step({}), step({});
  expect_true_pose(1e-3);
  EXPECT_EQ(drive->counts().starts, 1u);
}

TEST_F(KheperaTest, DrivesOnAfterAReset) {
  for (int k = 0; k < 20; ++k) step({0.1, 0, 0});
  khepera.restart();
  const base::Pose before = drive->state().X_WM;
  for (int k = 0; k < 4; ++k) step({0.1, 0, 0});
  EXPECT_LT(std::hypot(drive->state().X_WM.x - before.x, drive->state().X_WM.y - before.y), 0.06)
      << "the restart of the counters is no motion";
  EXPECT_EQ(khepera.left, 12) << "its speeds are sent again";
  EXPECT_EQ(drive->counts().starts, 2u);
  EXPECT_GE(drive->counts().wrong, 2u) << "its banner";
  EXPECT_TRUE(drive->ready(now));
}

TEST_F(KheperaTest, EndsACommandThatLostItsEnd) {
  khepera.damage = [](const std::string&) { return std::string(); };
  EXPECT_TRUE(khepera.obey());
  khepera.damage = {};
  wait(160 * kMs);
  wait(60 * kMs);
  exchange(3);
  EXPECT_EQ(drive->counts().timeouts, 1u);
  EXPECT_TRUE(drive->ready(now));
}

TEST_F(KheperaTest, IsStartedAgainAfterSilence) {
  step({0.1, 0, 0});
  khepera.damage = [](const std::string&) { return std::string(); };
  for (int k = 0; k < 60; ++k) wait(10 * kMs);
  EXPECT_NE(drive->problem(now).find("the Khepera on"), std::string::npos) << drive->problem(now);
  EXPECT_EQ(drive->counts().starts, 2u);
  khepera.damage = {};
  for (int k = 0; k < 30 && !drive->ready(now); ++k) {
    wait(200 * kMs);
    khepera.obey();
    wait(20 * kMs);
  }
  EXPECT_TRUE(drive->ready(now)) << drive->problem(now);
  step({0.1, 0, 0});
  EXPECT_EQ(khepera.left, 12);
}

TEST_F(KheperaTest, IgnoresGarbage) {
  khepera.say(std::string(500, '#') + "\r\nh,1\r\nn,1,2,3\r\nh,99999999999999999999,0\r\n\r\n,,,\r\n");
  exchange(10);
  EXPECT_TRUE(drive->ready(now));
  EXPECT_EQ(drive->counts().skipped_bytes, 500u);
  expect_true_pose(1e-6);
}

TEST(KheperaDrive, StopsTheWheelsOnDestruction) {
  KheperaEmulator khepera;
  auto drive = open_khepera(khepera.device());
  std::int64_t now = 60 * kMs;
  drive->update(now);
  for (int k = 0; k < 5; ++k) {
    drive->drive({0.1, 0, 0}, now);
    EXPECT_TRUE(khepera.obey());
    drive->update(now += 20 * kMs);
  }
  EXPECT_EQ(khepera.right, 12);
  drive.reset();  // no answer arrives, so it repeats the command
  EXPECT_TRUE(khepera.rests());
}

TEST(KheperaDrive, ReopensALineThatHungUp) {
  const std::filesystem::path name =
      std::filesystem::path(testing::TempDir()) / ("khepera-" + std::to_string(getpid()));
  auto khepera = std::make_unique<KheperaEmulator>();
  std::filesystem::create_symlink(khepera->device(), name);
  const auto drive = open_khepera(name.string());
  khepera->hang_up();
  drive->update(100 * kMs);
  EXPECT_NE(drive->problem(100 * kMs).find("was disconnected"), std::string::npos);
  std::filesystem::remove(name);
  for (int k = 2; k < 30; ++k) drive->update(k * 100 * kMs);
  EXPECT_EQ(drive->counts().lines, 1u) << "it is unplugged still";
  khepera = std::make_unique<KheperaEmulator>();
  std::filesystem::create_symlink(khepera->device(), name);
  std::int64_t now = 4 * kSecond;
  drive->update(now);
  drive->update(now += 60 * kMs);
  EXPECT_TRUE(khepera->obey());
  drive->update(now += 20 * kMs);
  EXPECT_TRUE(drive->ready(now)) << drive->problem(now);
  EXPECT_EQ(drive->counts().lines, 2u);
  std::filesystem::remove(name);
}

}  // namespace
}  // namespace sf::server
