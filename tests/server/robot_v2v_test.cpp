// Robots that exchange V2V without the farm.

#include <gtest/gtest.h>

#include "control/controllers.h"
#include "tests/server/fixture.h"

namespace sf::server {
namespace {

/// The other robots at the last step, per robot.
std::map<std::uint32_t, std::vector<control::Neighbour>>& seen_others() {
  static std::map<std::uint32_t, std::vector<control::Neighbour>> seen;
  return seen;
}

/// Drives forward, and needs no readings.
class V2vRecorder final : public control::Controller {
 public:
  explicit V2vRecorder(std::uint32_t mover) : mover_(mover) {}
  base::Twist step(const control::ControllerInput& input) override {
    seen_others()[mover_] = {input.others.begin(), input.others.end()};
    return {0.1, 0.0, 0.0};
  }
  double v2v_range() const override { return 100.0; }
  std::uint64_t needs() const override { return 0; }

 private:
  std::uint32_t mover_;
};

constinit const control::ControllerType v2v_recorder{
    .name = "test-v2v-recorder",
    .summary = "records other robots",
    .stops_on_bumper = false,
    .make = [](const control::ControllerContext& context, control::Settings&) -> std::unique_ptr<control::Controller> {
      return std::make_unique<V2vRecorder>(context.mover);
    }};

/// Both robots of the room.
struct RobotV2vTest : testing::Test {
  static void SetUpTestSuite() { control::add_controller(&v2v_recorder); }
  RobotV2vTest() { f.client.reset(), seen_others().clear(); }
  void make(double radio = netio::kV2vRange, bool direct = true) {
    const netio::Socket one = netio::open_udp({netio::kLoopback, 0}), two = netio::open_udp({netio::kLoopback, 0});
    ports = {netio::bound_endpoint(one).port, netio::bound_endpoint(two).port};
    for (const std::uint32_t mover : {0u, 1u}) {
      RobotClientOptions options{.log_descriptor = f.log.descriptor()};
      options.link.farm = {netio::kLoopback, f.service->port()};
      options.controller.name = v2v_recorder.name;
      if (direct)
        options.link.direct = netio::DirectV2vOptions{.peers = {{netio::kLoopback, ports[1 - mover]}}, .radio = radio};
      add.push_back(options);
    }
  }
  void start() {
    for (const std::uint32_t mover : {0u, 1u}) {
      if (add[mover].link.direct) add[mover].link.direct->bind = {netio::kLoopback, ports[mover]};
      robots.push_back(std::make_unique<RobotClient>(f.world, f.sensor_set, mover, f.layout, add[mover]));
    }
  }
  void run(int ticks, bool served) {
    for (int i = 0; i < ticks; ++i, f.now += kTick) {
      for (const auto& robot : robots) robot->receive(f.now), robot->step(f.now);
      if (served) f.service->tick(f.now);
    }
  }
  netio::DirectV2vCounts counts(std::size_t robot) const { return *robots[robot]->stats().link.direct; }

  Fixture f;
  std::array<std::uint16_t, 2> ports{};
  std::vector<RobotClientOptions> add;
  std::vector<std::unique_ptr<RobotClient>> robots;
};

TEST_F(RobotV2vTest, RobotsSeeEachOtherWithoutAFarm) {
  make();
  start();
  run(30, false);
  ASSERT_EQ(seen_others()[0].size(), 1u);
  EXPECT_EQ(seen_others()[0][0].id, 2u);
  EXPECT_NEAR(seen_others()[0][0].state.X_WM.x, 2.0 + 0.1 * 2.9, 0.03) << "where it drove to";
  ASSERT_EQ(seen_others()[1].size(), 1u);
  EXPECT_EQ(seen_others()[1][0].id, 1u);
  const RobotClientStats stats = robots[0]->stats();
  EXPECT_FALSE(stats.answered) << "the farm does not answer";
  EXPECT_FALSE(stats.listens) << "its controller needs no readings";
  EXPECT_EQ(counts(0).sent.sent, 30u);
  EXPECT_GE(counts(0).packets[netio::PacketStatus::accepted], 29u);
  robots.pop_back();
  for (int i = 0; i < 25; ++i, f.now += kTick) robots[0]->receive(f.now), robots[0]->step(f.now);
  EXPECT_TRUE(seen_others()[0].empty()) << "two seconds without a state";
}

TEST_F(RobotV2vTest, ByDefaultRobotsSeeOthersByTheFarmOnly) {
  make(netio::kV2vRange, false);
  start();
  run(10, false);
  EXPECT_TRUE(seen_others()[0].empty());
  EXPECT_FALSE(robots[0]->stats().link.direct);
}

TEST_F(RobotV2vTest, RelayedStatesCountOnce) {
  make();
  start();
  run(30, true);
  ASSERT_EQ(seen_others()[0].size(), 1u);
  const RobotClientStats stats = robots[0]->stats();
  EXPECT_TRUE(stats.answered);
  EXPECT_GT(stats.link.packets[netio::PacketStatus::accepted], 20u) << "relayed";
  EXPECT_GE(counts(0).packets[netio::PacketStatus::accepted], 29u);
  EXPECT_GT(counts(0).duplicates, 20u);
}

TEST_F(RobotV2vTest, RobotsStillSeeEachOtherAfterTheFarmFails) {
  make();
  start();
  run(20, true);
  f.service = nullptr;
  run(40, false);
  ASSERT_EQ(seen_others()[0].size(), 1u);
  EXPECT_NEAR(seen_others()[0][0].state.X_WM.x, robots[1]->stats().pose.x, 0.03);
}

/// The robots are 4.1 m apart.
TEST_F(RobotV2vTest, RobotsBeyondRadioRangeAreNotSeen) {
  make(4.0);
  start();
  run(10, false);
  EXPECT_TRUE(seen_others()[0].empty());
  EXPECT_GE(counts(0).far, 8u);
}

TEST_F(RobotV2vTest, KeysMustAgree) {
  const netio::Peer one{netio::PeerKind::robot, 1, std::nullopt, netio::SigningKey{1}},
      two{netio::PeerKind::robot, 2, std::nullopt, netio::SigningKey{2}},
      forged{netio::PeerKind::robot, 2, std::nullopt, netio::SigningKey{3}};
  make();
  add[0].link.direct->table = {one, two};
  add[1].link.direct->table = {one, forged};
  start();
  run(10, false);
  EXPECT_TRUE(seen_others()[0].empty()) << "robot 2 signs with another key";
  EXPECT_GE(counts(0).packets[netio::PacketStatus::wrong_signature], 9u);
  EXPECT_EQ(seen_others()[1].size(), 1u) << "both have the key of robot 1";
  EXPECT_NE(f.log.read_all().find("direct V2V of robot 2"), std::string::npos);
}

/// Packets pass the injected link in both directions.
TEST_F(RobotV2vTest, TheInjectedLinkLosesDirectV2v) {
  make();
  for (RobotClientOptions& options : add) options.link.model = {.loss = 1.0};
  start();
  run(10, false);
  EXPECT_TRUE(seen_others()[0].empty());
  EXPECT_EQ(counts(0).sent.sent, 0u);
}

}  // namespace
}  // namespace sf::server
