// The driver of robots behind a Player server, with an emulated server on loopback.

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

#include "sensors/battery.h"
#include "sensors/bumper.h"
#include "sensors/infrared.h"
#include "sensors/laser.h"
#include "sensors/sonar.h"
#include "server/player_drive.h"
#include "tests/player_emulator.h"
#include "tests/refusal.h"
#include "tests/server/own_values.h"
#include "tests/units.h"

namespace sf::server {
namespace {

using Bytes = PlayerEmulator::Bytes;

std::unique_ptr<RealRobot> open_player(const PlayerEmulator& player, const base::Pose& X_WM = {}) {
  return make_real_robot({.type = "player", .server = player.endpoint()}, X_WM, 0.3);
}

struct PlayerDriveTest : testing::Test {
  PlayerDriveTest() : drive(open_player(player, {1, 2, 0, 0.5})) { player.X = {1, 2, 0, 0.5}; }

  /// Serves and updates, at the same time of the robot's clock, until `done`. Fails after ten seconds.
  template <class Done>
  void until(Done done) {
    for (int k = 0; k < 10'000 && !done(); ++k) {
      player.serve();
      drive->update(now);
      if (!done()) poll(nullptr, 0, 1);
    }
    EXPECT_TRUE(done());
  }
  /// Until a state has arrived.
  void connect() {
    const std::uint64_t before = drive->counts().frames;
    // The list, five devices, motors and geometry.
    until([&] { return player.open.size() == 5 && drive->counts().frames >= before + 8; });
    cycle();
  }
  /// Sends the data of 100 ms, until the state, which is the last of it, has arrived.
  void cycle() {
    const std::uint64_t before = drive->counts().frames;
    player.run();
    now += kTick;
    until([&] { return drive->counts().frames >= before + 5; });
  }
  void step(const base::Twist& twist) {
    const std::uint64_t before = player.commands;
    drive->drive(twist, now);
    until([&] { return player.commands > before; });
    cycle();
  }
  void send(const Bytes& bytes) {
    const RealRobotCounts before = drive->counts();
    player.send(bytes);
    until([&] { return drive->counts().frames + drive->counts().wrong > before.frames + before.wrong; });
  }
  void wait(std::int64_t time) { drive->update(now += time); }
  std::vector<double> values(std::uint8_t type) const { return own_values(*drive, type); }

  PlayerEmulator player;
  std::unique_ptr<RealRobot> drive;
  std::int64_t now = 0;
};

TEST_F(PlayerDriveTest, DrivesAndTracksItsPose) {
  EXPECT_FALSE(drive->ready(0)) << "not connected yet";
  player.X_OM = {-7, 3, 0, 3.0};  // the odometry of an earlier program
  connect();
  EXPECT_TRUE(drive->ready(now)) << drive->problem(now);
  for (int k = 0; k < 100; ++k) step({0.5, 0, 0.4});
  EXPECT_NEAR(drive->state().X_WM.x, player.X.x, 1e-9);
  EXPECT_NEAR(drive->state().X_WM.y, player.X.y, 1e-9);
  EXPECT_NEAR(base::wrap_angle(drive->state().X_WM.yaw - player.X.yaw), 0.0, 1e-9);
  EXPECT_NEAR(drive->state().velocity.forward, 0.5, 0.01);
  EXPECT_NEAR(drive->state().velocity.turn, 0.4, 0.01);
  EXPECT_EQ(player.unknown, 0u);
  EXPECT_EQ(player.commands, 100u);
  EXPECT_EQ(drive->counts().wrong, 0u);
  EXPECT_EQ(drive->counts().starts, 1u);
}

TEST_F(PlayerDriveTest, SidewaysSpeedIsCommanded) {
  connect();
  step({0.1, -0.2, 0.3});
  EXPECT_EQ(player.left, -0.2);
}

TEST_F(PlayerDriveTest, ReportsItsSensors) {
  connect();
  EXPECT_EQ(player.open.count(PlayerEmulator::kLaser), 0u) << "its beams are unknown to controllers";
  EXPECT_EQ(values(sensors::kSonar), (std::vector<double>{2.5, 5.0}));
  EXPECT_EQ(values(sensors::kBumper), (std::vector<double>{0, 0}));
  const std::vector<double> infrared = values(sensors::kInfrared);
  ASSERT_EQ(infrared.size(), 4u);
  EXPECT_NEAR(infrared[0], 0.01, 1e-6);
  EXPECT_EQ(infrared[1], 512.0) << "half of the voltage";
  EXPECT_EQ(infrared[3], 0.0);
  const std::vector<double> battery = values(sensors::kBattery);
  ASSERT_EQ(battery.size(), 4u);
  EXPECT_EQ(battery[0], 12.5);
  EXPECT_TRUE(std::isnan(battery[1]) && std::isnan(battery[2])) << "unknown";
  const std::vector<RobotFact> facts = drive->facts();
  ASSERT_EQ(facts.size(), 5u);
  EXPECT_EQ(facts[0].name, "battery_V");
  EXPECT_EQ(facts[0].value, 12.5);
  EXPECT_EQ(facts[1].name, "charge_percent");
  EXPECT_EQ(facts[3].name, "length_m");
  EXPECT_EQ(facts[3].value, 0.4);
}

TEST_F(PlayerDriveTest, StallsAndBumpersAreContacts) {
  connect();
  EXPECT_FALSE(drive->contact());
  player.bumper = 1;
  cycle();
  send(PlayerEmulator::message(PlayerEmulator::kPosition, 1, 1, Bytes(52)));
  EXPECT_TRUE(drive->contact()) << "still pressed when only a state arrives";
  player.bumper = 0;
  cycle(), cycle();
  EXPECT_FALSE(drive->contact());
  player.stall = 1;
  cycle();
  EXPECT_TRUE(drive->contact());
}

TEST_F(PlayerDriveTest, AnOdometryThatIsSetIsNoMotion) {
  connect();
  step({0.5, 0, 0});
  player.X_OM = {100, 0, 0, -2};
  cycle();
  const double x = drive->state().X_WM.x;
  step({0, 0, 0});
  EXPECT_NEAR(drive->state().X_WM.x, x, 1e-9);
  EXPECT_NEAR(drive->state().X_WM.yaw, 0.5, 1e-9);
}

/// Reconnects once a second, and never repeats commands for a robot that it does not reach.
TEST_F(PlayerDriveTest, ReconnectsAfterTheServerRestarts) {
  connect();
  for (int k = 0; k < 10; ++k) step({0.5, 0, 0});
  const base::Pose before = drive->state().X_WM;
  player.end();
  for (int k = 0; k < 30; ++k) {
    drive->drive({0.5, 0, 0}, now);
    wait(kTick);
  }
  EXPECT_NE(drive->problem(now).find("the connection to the Player server at 127.0.0.1:"), std::string::npos)
      << drive->problem(now);
  EXPECT_EQ(drive->state().velocity.forward, 0.0);
  player.start();
  player.X_OM = {};
  now += kSecond;
  connect();
  EXPECT_EQ(player.connections, 2u);
  EXPECT_EQ(player.commands, 10u);
  EXPECT_TRUE(drive->ready(now)) << drive->problem(now);
  EXPECT_NEAR(drive->state().X_WM.x, before.x, 1e-9) << "the restart of its odometry is no motion";
  step({0.5, 0, 0});
  EXPECT_EQ(player.forward, 0.5);
}

/// A driver may take seconds to start, so a silent server is left only after ten.
TEST_F(PlayerDriveTest, WaitsForASlowDriver) {
  until([&] { return player.open.size() == 5 && player.motors == 1; });
  for (int k = 0; k < 90; ++k) wait(kTick);
  EXPECT_NE(drive->problem(now).find("its driver is starting"), std::string::npos) << drive->problem(now);
  drive->drive({0.5, 0, 0}, now);
  until([&] { return player.commands == 1; });
  EXPECT_EQ(player.forward, 0.0) << "it is not ready";
  cycle();
  EXPECT_TRUE(drive->ready(now)) << drive->problem(now);
  EXPECT_EQ(drive->counts().lines, 1u);
  for (int k = 0; k < 120; ++k) wait(kTick);
  player.serve();
  EXPECT_EQ(drive->counts().lines, 2u);
}

TEST_F(PlayerDriveTest, StopsWithoutStates) {
  connect();
  step({0.5, 0, 0});
  for (int k = 0; k < 6; ++k) {
    player.send_data(PlayerEmulator::kSonar, PlayerEmulator::array({1.0f}));
    wait(kTick);
  }
  EXPECT_FALSE(drive->ready(now)) << "other data does not replace states";
  drive->drive({0.5, 0, 0}, now);
  until([&] { return player.forward == 0.0; });
}

TEST_F(PlayerDriveTest, StopsTheRobotOnDestruction) {
  connect();
  step({0.5, 0, 0});
  drive.reset();
  const std::uint64_t before = player.commands;
  for (int k = 0; k < 1000 && player.commands == before && player.forward != 0.0; ++k)
    player.serve(), poll(nullptr, 0, 1);
  EXPECT_EQ(player.forward, 0.0);
}

/// Their messages have the right length in the header, and a payload that cannot be read.
TEST_F(PlayerDriveTest, MalformedDataIsCountedAndDropped) {
  connect();
  step({0.5, 0, 0});
  const base::Pose before = drive->state().X_WM;
  const float inf = HUGE_VALF;
  const double nan = std::nan("");
  using P = PlayerEmulator;
  const std::vector<std::pair<std::uint32_t, Bytes>> malformed{
      {P::kPosition, {}},                                      // empty
      {P::kPosition, P::numbers<double>({0, 0, 0, 0, 0, 0})},  // no stall
      {P::kPosition, Bytes(56)},                               // one word too many
      {P::kPosition, P::joined(P::numbers<double>({nan, 0, 0, 0, 0, 0}), P::word_of(0))},
      {P::kPosition, P::joined(P::numbers<double>({0, 0, HUGE_VAL, 0, 0, 0}), P::word_of(0))},
      {P::kSonar, P::numbers<std::uint32_t>({2, 3, 0, 0})},              // counts that differ
      {P::kSonar, P::numbers<std::uint32_t>({0xFFFFFFFF, 0xFFFFFFFF})},  // more than the payload
      {P::kSonar, P::array(std::vector<float>(2000))},                   // more than any ring has
      {P::kSonar, P::array({inf})},
      {P::kSonar, P::array({-1.0f})},
      {P::kInfrared, P::array({1.0f})},  // no ranges
      {P::kBumper, P::numbers<std::uint32_t>({9, 9, 0})},
      {P::kPower, P::word_of(31)},
      {P::kPower, P::joined(P::word_of(1), P::joined(P::numbers<float>({inf, 0, 0, 0}), P::word_of(0)))}};
  for (const auto& [interf, payload] : malformed) {
    const std::uint64_t wrong = drive->counts().wrong;
    send(P::message(interf, 1, 1, payload));
    EXPECT_EQ(drive->counts().wrong, wrong + 1) << interf << ", " << payload.size() << " bytes";
  }
  EXPECT_EQ(drive->state().X_WM.x, before.x);
  step({0.5, 0, 0});
  EXPECT_TRUE(drive->ready(now)) << drive->problem(now);
  EXPECT_EQ(player.connections, 1u);
}

TEST_F(PlayerDriveTest, AMessageThatIsTooLongEndsTheConnection) {
  connect();
  Bytes header = PlayerEmulator::message(PlayerEmulator::kPosition, 1, 1, {});
  header[36] = 0xFF;
  send(header);
  EXPECT_NE(drive->problem(now).find("sent a message of 4278190080 bytes"), std::string::npos) << drive->problem(now);
  now += 2 * kSecond;
  connect();
  EXPECT_TRUE(drive->ready(now)) << drive->problem(now);
}

/// Random changes of valid messages, in pieces of random lengths.
TEST_F(PlayerDriveTest, SurvivesRandomBytes) {
  std::mt19937 random(7);
  for (int round = 0; round < 60; ++round) {
    until([&] { return !player.open.empty(); });
    for (int k = 0; k < 20; ++k) {
      Bytes bytes;
      for (const std::uint32_t interf : {1u, 2u, 4u, 5u, 14u, 22u}) {
        const Bytes one = PlayerEmulator::message(interf, 1 + static_cast<std::uint32_t>(random() % 6),
                                                  1 + static_cast<std::uint32_t>(random() % 3), Bytes(random() % 80));
        bytes.insert(bytes.end(), one.begin(), one.end());
      }
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
      if (random() % 4 == 0) bytes.resize(random() % bytes.size());
      player.send(bytes);
      drive->update(now);
    }
    player.hang_up();
    now += 2 * kSecond;
    drive->update(now);
  }
  for (int k = 0; k < 20 && !drive->ready(now); ++k) {
    now += kSecond;
    for (int i = 0; i < 50; ++i) player.serve(), drive->update(now), poll(nullptr, 0, 1);
    player.run();
    for (int i = 0; i < 20; ++i) drive->update(now), poll(nullptr, 0, 1);
  }
  EXPECT_TRUE(drive->ready(now)) << drive->problem(now);
  EXPECT_TRUE(std::isfinite(drive->state().X_WM.x));
  EXPECT_GT(drive->counts().wrong, 50u);
}

TEST(PlayerDrive, NamesTheDeviceThatIsMissing) {
  PlayerEmulator player;
  player.devices = {PlayerEmulator::kSonar};
  const auto drive = open_player(player);
  for (int k = 0; k < 1000 && drive->counts().frames < 2; ++k) player.serve(), drive->update(0), poll(nullptr, 0, 1);
  EXPECT_NE(drive->problem(0).find("has no device position2d:0"), std::string::npos) << drive->problem(0);
}

TEST(PlayerDrive, NamesADeviceThatIsNotOpened) {
  PlayerEmulator player;
  player.grants = false;
  const auto drive = open_player(player);
  for (int k = 0; k < 1000 && drive->counts().frames < 2; ++k) player.serve(), drive->update(0), poll(nullptr, 0, 1);
  EXPECT_NE(drive->problem(0).find("does not open position2d:0"), std::string::npos) << drive->problem(0);
  drive->drive({1, 0, 0}, 0);
  player.serve();
  EXPECT_EQ(player.commands, 0u);
}

TEST(PlayerDrive, AnotherServerIsNamed) {
  PlayerEmulator player;
  player.banner = "SSH-2.0-OpenSSH_9.2";
  const auto drive = open_player(player);
  for (int k = 0; k < 1000 && drive->counts().wrong == 0; ++k) player.serve(), drive->update(0), poll(nullptr, 0, 1);
  EXPECT_NE(drive->problem(0).find("is not a Player server"), std::string::npos) << drive->problem(0);
}

TEST(PlayerDrive, WithoutAServerItIsRefused) {
  PlayerEmulator player;
  player.end();
  expect_in("cannot connect to TCP " + netio::endpoint_text(player.endpoint()) + ": Connection refused",
            refusal_of([&] { open_player(player); }));
}

}  // namespace
}  // namespace sf::server
