// Lanes that operators of a serving farm close and reverse, and what robots receive.

#include "server/lane_service.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "netio/v2v_socket.h"
#include "sensors/sensor_type.h"
#include "server/service.h"
#include "tests/netio/log_pipe.h"
#include "tests/units.h"
#include "world/roads/roads.h"

namespace sf::server {
namespace {

constexpr netio::SigningKey kOperator{9, 8, 7};
const netio::Lane kOpen{1, 1, 0}, kClosed{1, 1, 1}, kReversed{1, 1, 0, true};

/// A farm of SimVille without sensors, a robot on lane 1.1 or elsewhere, and an operator.
struct Town {
  explicit Town(const std::vector<netio::Peer>& peers = {})
      : world(world::load_world(SF_SOURCE_DIR "/worlds/simville/simville.world",
                                {.sensors = sensors::world_file_words()})) {
    for (world::Mover& mover : world.movers) mover.sensors.clear();
    sensor_set.emplace(world);
    service.emplace(
        world, *sensor_set, device(), layout,
        ServiceOptions{
            .receiver = {.bind = {netio::kLoopback, 0}, .log_descriptor = log.descriptor(), .peers = peers}});
    robot.emplace(netio::V2vSocketOptions{.farm = {netio::kLoopback, service->port()}, .robot = 1});
    roads = world::roads_of(world);
  }
  static gpu::Device& device() {
    static gpu::Device device;
    return device;
  }
  void ask(const netio::Lane& lane, netio::PacketSigner* signer = nullptr) {
    netio::encode({.robot = netio::kBroadcastId}, lane, bytes);
    if (signer != nullptr) signer->sign(bytes);
    outbox.queue({netio::kLoopback, service->port()}, bytes);
    outbox.flush();
  }
  /// Runs with the robot on a lane, `s` [m] along it. Returns the newest use of lane 1.1 that it received.
  std::optional<netio::Lane> run(int ticks, const std::string& lane = "3.1") {
    const glm::dvec2 p = point_at(roads->lanes[lane_named(*roads, lane)].centre, 1.0);
    for (int i = 0; i < ticks; ++i, now += kTick, ++sequence) {
      netio::encode({.robot = 1, .sequence = sequence}, netio::V2v{.X_WR = {p.x, p.y, 0.0, 0.0}}, bytes);
      robot->send(bytes);
      netio::encode({.robot = 1, .sequence = sequence}, netio::Subscribe{netio::kNeighboursBit}, bytes);
      robot->send(bytes);
      service->tick(now);
      robot->receive([&](std::span<const std::uint8_t> one) {
        netio::Packet packet;
        if (robot->accept(one, now, packet) != netio::PacketStatus::accepted) return;
        if (const auto* received = std::get_if<netio::Lane>(&packet.body)) newest = *received, ++packets;
      });
    }
    return newest;
  }

  world::World world;
  std::optional<sensors::SensorSet> sensor_set;
  StreamLayout layout;
  netio::LogPipe log;
  std::optional<world::RoadNetwork> roads;
  std::optional<Service> service;
  std::optional<netio::V2vSocket> robot;
  netio::Outbox outbox;
  base::Bytes bytes;
  std::uint32_t sequence = 0;
  std::optional<netio::Lane> newest;
  std::size_t packets = 0;
  std::int64_t now = 0;
};

TEST(LaneService, RobotsReceiveTheUsesOfChangedLanes) {
  Town town;
  EXPECT_FALSE(town.run(10));
  town.ask(kClosed);
  EXPECT_EQ(town.run(2), kClosed) << "at once";
  town.packets = 0;
  town.run(30);
  EXPECT_EQ(town.packets, 3u) << "every second";
  town.ask(kOpen);
  EXPECT_EQ(town.run(2), kOpen);
  EXPECT_NE(town.log.read_all().find("lane 1.1 is closed\n"), std::string::npos);
}

/// The robot is in the lane, which stays closed until it has left for two seconds.
TEST(LaneService, ALaneIsReversedOnceItIsEmpty) {
  Town town;
  town.run(5, "1.1");
  town.ask(kReversed);
  EXPECT_EQ(town.run(40, "1.1"), kClosed);
  EXPECT_EQ(town.run(18), kClosed) << "empty for less than 2 s";
  EXPECT_EQ(town.run(5), kReversed);
  const std::string log = town.log.read_all();
  EXPECT_NE(log.find("lane 1.1 is closed until it is empty, then it changes its direction"), std::string::npos) << log;
  EXPECT_NE(log.find("lane 1.1 is reversed"), std::string::npos) << log;
}

TEST(LaneService, RefusedRequestsAreLogged) {
  Town town;
  town.ask({99, 1, 1});
  town.ask({3, 1, 4});
  EXPECT_FALSE(town.run(3));
  EXPECT_EQ(town.service->lanes().refused(), 2u);
  const std::string log = town.log.read_all();
  EXPECT_NE(log.find("LANE 99.1: 'closed' is refused: "), std::string::npos) << log;
  EXPECT_NE(log.find("lane 3.1 has no exit at its end that turns right"), std::string::npos) << log;
  for (std::uint32_t lane = 100; lane < 300; ++lane) town.ask({1, lane, 1});
  town.run(1);
  EXPECT_EQ(town.service->lanes().refused(), 202u) << "all, but only 64 of them one by one";
}

/// Each request that is tried builds the road network anew.
TEST(LaneService, RequestsForManyLanesAreSpreadOverTicks) {
  Town town;
  std::size_t asked = 0;
  for (const world::RoadLane& lane : town.roads->lanes) {
    if (asked == 10) break;
    town.ask({static_cast<std::uint32_t>(town.roads->segments[lane.segment].id),
              static_cast<std::uint32_t>(lane.number), 1});
    ++asked;
  }
  ASSERT_EQ(asked, 10u);
  const auto closed = [&] {
    const auto uses = town.service->lanes().uses();
    return std::count_if(uses.begin(), uses.end(), [](const world::LaneUse& use) { return use != world::LaneUse{}; });
  };
  for (const int expected : {4, 8, 10, 10}) {
    town.run(1);
    EXPECT_EQ(closed(), expected);
  }
  EXPECT_EQ(town.service->lanes().refused(), 0u);
}

TEST(LaneService, OnlyTheOperatorOfAKeyChangesLanes) {
  Town town({{netio::PeerKind::start, 0, std::nullopt, kOperator}});
  netio::PacketSigner forger(netio::SigningKey{1}), genuine(kOperator);
  town.ask(kClosed);
  town.ask(kClosed, &forger);
  EXPECT_FALSE(town.run(3));
  EXPECT_EQ(town.service->stats().inbox[netio::PacketStatus::not_signed], 1u);
  EXPECT_EQ(town.service->stats().inbox[netio::PacketStatus::wrong_signature], 1u);
  town.ask(kClosed, &genuine);
  EXPECT_EQ(town.run(3), kClosed);
}

TEST(ReceivedLanes, MakeANetworkOfTheUses) {
  Town town;
  ReceivedLanes lanes(&*town.roads), none(nullptr);
  EXPECT_FALSE(none.take(kClosed));
  EXPECT_FALSE(lanes.take({99, 1, 1}));
  EXPECT_TRUE(lanes.take(kOpen));
  EXPECT_EQ(lanes.network(), nullptr);
  EXPECT_TRUE(lanes.take(kReversed));
  const auto network = lanes.network();
  ASSERT_NE(network, nullptr);
  EXPECT_EQ(network->lanes[lane_named(*network, "1.1")].points.front().id.point, 17);
  EXPECT_TRUE(lanes.take(kReversed));
  EXPECT_EQ(lanes.network(), network) << "nothing new";
}

}  // namespace
}  // namespace sf::server
