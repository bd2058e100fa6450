// Commands of users of a service's bridges reach the process that owns the robot.

#include "server/drive_relay.h"

#include "tests/server/fixture.h"

namespace sf::server {
namespace {

TEST(DriveRelay, TheOwningProcessDrivesByCommandsAndStopsWithoutThem) {
  for (const double loss : {0.0, 0.3}) {
    Fixture f({.loss = loss, .controller = "remote"});
    f.run(20);
    EXPECT_TRUE(f.service->drives().follows(0));
    EXPECT_FALSE(f.service->drives().follows(1)) << "no process";
    EXPECT_EQ(f.client->stats().distance_m, 0.0);
    f.service->drives().command(0, {0.2, 0.0, 0.0});
    f.run(20);
    const double there = f.client->stats().distance_m;
    EXPECT_GT(there, 0.2) << loss;
    EXPECT_GT(f.client->stats().drives, loss > 0.0 ? 8u : 18u);
    f.run(20, false);  // the farm is away
    EXPECT_NEAR(f.client->stats().distance_m, there, 0.2 * 0.8) << "stops after 0.5 s";
  }
}

/// Keyed robots verify DRIVE; the fixture's farm signs it.
TEST(DriveRelay, SignsCommandsOfRobotsWithAKey) {
  const netio::Peer peer{netio::PeerKind::robot, 1, std::nullopt, netio::SigningKey{7}};
  Fixture f({.peers = {peer}, .controller = "remote"});
  f.run(10);
  f.service->drives().command(0, {0.2, 0.0, 0.0});
  f.run(20);
  EXPECT_GT(f.client->stats().distance_m, 0.2);
  EXPECT_EQ(f.client->stats().link.packets[netio::PacketStatus::not_signed], 0u);
}

/// The newest command of any client counts. One packet per robot and tick, whatever the number of commands.
TEST(DriveRelay, SendsOnePacketPerTickAndEndsAtRest) {
  Fixture f({.controller = "remote"});
  f.run(10);
  DriveRelay& drives = f.service->drives();
  for (int i = 0; i < 1000; ++i) drives.command(0, {1e9, 0.0, 0.0});
  drives.command(0, {-0.1, 0.0, 0.0});
  f.run(5);
  EXPECT_EQ(drives.counts().sent, 5u);
  EXPECT_LT(f.client->stats().pose.x, -2.0) << "by the last command";
  drives.command(0, {});
  f.run(30);
  EXPECT_EQ(drives.counts().sent, 5u + 11u) << "rest is repeated for a second";
}

TEST(DriveRelay, ReportsRobotsThatNoProcessDrives) {
  Fixture f;  // controller 'wander'
  f.run(10);
  DriveRelay& drives = f.service->drives();
  for (int i = 0; i < 20; ++i) {
    drives.command(0, {0.2, 0.0, 0.0});
    drives.command(1, {0.2, 0.0, 0.0});
    f.run(1);
  }
  EXPECT_EQ(drives.counts().sent, 0u);
  EXPECT_EQ(drives.counts().dropped, 40u);
  const std::string log = f.log.read_all();
  const std::string first = "robot1 (id 1) are dropped: its process runs another controller";
  const std::string second = "robot2 (id 2) are dropped: no process sends its state";
  EXPECT_NE(log.find(first), std::string::npos) << log;
  EXPECT_NE(log.find(second), std::string::npos) << log;
  EXPECT_EQ(log.find(first), log.rfind(first)) << "at most every ten seconds";
}

/// A packet that the farm sends all the same, such as one in flight: it is counted, and the controller continues.
TEST(DriveRelay, OtherControllersIgnoreAndCountThePacket) {
  Fixture f;
  f.run(10);
  base::Bytes packet;
  netio::encode({.robot = 1}, netio::Drive{{-0.3, 0.0, 0.0}}, packet);
  f.service->receiver().queue(1, packet);
  f.run(10);
  EXPECT_EQ(f.client->stats().drives_ignored, 1u);
  EXPECT_EQ(f.client->stats().drives, 0u);
  EXPECT_NE(f.log.read_all().find("which controller 'wander' ignores"), std::string::npos);
}

/// A robot that needs no readings continues while its virtual sensors are silent.
TEST(Service, ARobotThatNeedsNoReadingsContinuesWithoutTheFarm) {
  Fixture f({.controller = "remote"});
  f.run(10);
  const std::uint64_t steps = f.client->stats().steps;
  f.run(40, false);
  EXPECT_EQ(f.client->stats().steps, steps + 40u);
  EXPECT_EQ(f.client->stats().stops, 0u);
  EXPECT_NE(f.log.read_all().find("The robot continues"), std::string::npos);
}

TEST(Service, StopWithoutFarmStopsEveryController) {
  Fixture f({.controller = "remote", .stop_without_farm = true});
  f.run(10);
  f.run(20, false);
  EXPECT_EQ(f.client->stats().stops, 1u);
}

}  // namespace
}  // namespace sf::server
