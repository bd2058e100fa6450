// A robot's link, with a farm simulated by the test.

#include "server/robot_link.h"

#include <cmath>

#include "sensors/laser_packets.h"
#include "tests/server/fixture.h"

namespace sf::server {
namespace {

using netio::PacketStatus;
using netio::Type;

constexpr std::uint32_t kPlayedFarm = 0xFA23;                           ///< session
constexpr netio::LinkModel kLossy{.loss = 0.5, .seed = 3};              ///< some of the datagrams of each test are lost
constexpr std::uint32_t kScans = std::uint32_t{sensors::kLaser} << 16;  ///< stream of the injected link

/// Returns whether the injected link loses a message of robot 1: 0 or 1.
std::uint64_t loses(std::uint32_t stream, std::uint64_t sequence) {
  return netio::sample_delay(kLossy, {1, stream, sequence}) ? 0 : 1;
}
std::uint32_t stream_of(Type type, std::uint32_t low) { return static_cast<std::uint32_t>(type) << 16 | low; }

/// The link of robot1.
struct PlayedFarm : Fixture {
  explicit PlayedFarm(const netio::LinkModel& model = {}, const Settings& chosen = {}) : Fixture(chosen) {
    client.reset();  // releases its ports
    link = std::make_unique<RobotLink>(world, sensor_set, 0, layout,
                                       LinkOptions{.farm = outbox.endpoint(), .model = model},
                                       [](const netio::Packet&, std::int64_t) {});
  }
  /// Returns the types of the packets received from the robot since the last call.
  std::vector<Type> received_types() {
    std::vector<Type> types;
    batch.drain(socket, 1000, [&](std::span<const std::uint8_t> bytes, const netio::Endpoint& source) {
      netio::Packet packet;
      EXPECT_EQ(netio::decode(bytes, packet), PacketStatus::accepted);
      robot = source, session = packet.header.session;
      types.push_back(packet.header.type);
    });
    return types;
  }
  template <class Body>
  void send(const netio::Header& header, const Body& body) {
    base::Bytes bytes;
    netio::encode(header, body, bytes);
    outbox.queue(robot, bytes, stamp);
    outbox.flush();
    link->run(now);
  }
  /// Makes the robot accept the farm of that session.
  void challenge(std::uint32_t farm) {
    received_types();
    stamp = {farm, session};
    send({}, netio::Challenge{5});
  }
  void greet() {
    link->send_request(now);
    challenge(kPlayedFarm);
  }
  void send_scan(netio::Outbox& from, netio::Header header, std::uint32_t part = 0) {
    const sensors::SensorSet::Group& lasers = *sensor_set.group(sensors::kLaser);
    const std::vector<double> ranges(lasers.rows[0].elements, range_of(header.sequence, part));
    base::ReadingBlock block;
    block.type = sensors::kLaser, block.values = ranges;
    base::Bytes payload, bytes;
    const std::uint8_t type = lasers.type->encode(lasers.rows[0], block, sensors::WireFormat::farm, part, payload);
    header.robot = 1, header.session = stamp.session, header.token = stamp.token;
    netio::encode_reading(header, type, payload, bytes);
    from.queue({netio::kLoopback, reading_port(1)}, bytes);
    from.flush();
    link->run(now);
  }
  static double range_of(std::uint32_t sequence, std::uint32_t part) { return 0.5 * (sequence % 8) + 0.125 * part; }
  std::uint64_t scans() const { return link->counts().whole.at("laser"); }

  netio::Socket socket = netio::open_udp({netio::kLoopback, 0});
  netio::Outbox outbox{netio::duplicate(socket)};
  netio::ReceiveBatch batch{64};
  netio::Endpoint robot;
  std::uint32_t session = 0;  ///< of the robot
  netio::SessionToken stamp;
  std::unique_ptr<RobotLink> link;
};

TEST(RobotLink, AcceptsOnlyReadingsOfItsFarm) {
  PlayedFarm f;
  f.greet();
  netio::Outbox stranger(netio::open_udp({netio::kLoopback, 0}));
  f.send_scan(stranger, {.sequence = 1});
  EXPECT_EQ(f.scans(), 0u);
  ++f.stamp.session;
  f.send_scan(f.outbox, {.sequence = 1});
  EXPECT_EQ(f.link->counts().readings.packets[PacketStatus::wrong_source], 2u);
  EXPECT_FALSE(f.link->last_answer()) << "no valid packet arrived";
  --f.stamp.session;
  f.now = 7;
  f.send_scan(f.outbox, {.sequence = 1});
  EXPECT_EQ(f.scans(), 1u);
  EXPECT_EQ(f.link->last_answer(), 7);
}

/// Packets do not show which elements are flagged, so controllers receive the bound only if it holds for all of them.
TEST(RobotLink, ReadingsHaveTheBoundsOfTheirPackets) {
  PlayedFarm f;
  f.greet();
  std::uint32_t sequence = 0;
  const auto received = [&](const netio::Accuracy& accuracy) {
    f.send_scan(f.outbox, {.sequence = ++sequence, .accuracy = netio::encode_accuracy(accuracy)});
    const base::ReadingBlock block = f.link->readings()[0].block;
    EXPECT_EQ(block.bound_without_noise, block.bound);
    EXPECT_EQ(block.sequence, sequence);
    return block.bound;
  };
  EXPECT_NEAR(received({0, false, 0.5e-3}), 0.51e-3, 0.02e-3);
  EXPECT_TRUE(std::isinf(received({2, true, 0.5e-3}))) << "not for every element";
  EXPECT_TRUE(std::isinf(received({0, true, HUGE_VAL}))) << "noise";
  EXPECT_TRUE(std::isinf(received({0, false, HUGE_VAL}))) << "none";
}

TEST(RobotLink, AcceptsAFarmOnThisMachineOnlyOverLoopback) {
  const PlayedFarm f;
  EXPECT_NO_THROW(netio::open_udp({netio::kLoopback + 1, f.reading_port(1)})) << "taken, if bound to all addresses";
}

TEST(RobotLink, ReadingsOfAStaleStateAreCounted) {
  PlayedFarm f;
  f.greet();
  std::uint32_t sequence = 0;
  for (const bool stale : {false, true, false, true, true})
    f.send_scan(f.outbox, {.sequence = ++sequence, .state = {.stated = true, .stale = stale, .age = 1000}});
  EXPECT_EQ(f.scans(), 5u);
  EXPECT_EQ(f.link->counts().stale, 3u);
}

/// Each datagram of a reading is delayed or lost separately. The first one is treated exactly as the reading in a
/// simulation with the same link.
TEST(RobotLink, DelaysAndLosesReadingsAsTheInjectedLinkDoes) {
  PlayedFarm f(kLossy);
  std::uint64_t lost = 0;
  for (std::uint32_t sequence = 1; sequence <= 20; ++sequence)
    for (const std::uint64_t piece : {0, 1}) {
      f.send_scan(f.outbox, {.sequence = sequence});
      lost += loses(kScans, piece << 32 | sequence);
      ASSERT_EQ(f.link->counts().in.lost, lost) << sequence << ", datagram " << piece;
    }
}

/// Scans of three datagrams.
struct ScansInParts : PlayedFarm {
  explicit ScansInParts(const netio::LinkModel& model = {}) : PlayedFarm(model, {.samples = 700}) {
    greet();
    while (model.loss > 0.0 && now < 10 * kSecond) now += kSecond, greet();  // some of it is lost
  }
  void send_parts(std::uint32_t sequence, const std::vector<std::uint32_t>& parts) {
    for (const std::uint32_t part : parts)
      send_scan(outbox, {.sequence = sequence, .time = sequence * kTick, .state = {.stated = true, .stale = true}},
                part);
  }
  /// Checks that this is the newest scan, with each part at its place.
  void expect_newest(std::uint32_t sequence) {
    const auto newest = link->readings();
    ASSERT_EQ(newest.size(), 1u);
    EXPECT_EQ(newest[0].block.sequence, sequence);
    ASSERT_EQ(newest[0].block.values.size(), 700u);
    for (std::uint32_t i = 0; i < 700; ++i)
      ASSERT_DOUBLE_EQ(newest[0].block.values[i], range_of(sequence, i / sensors::kPartRays)) << i;
  }
};

TEST(RobotLink, AReadingWithALostPartIsDropped) {
  ScansInParts f;
  f.now = 7;
  f.send_parts(1, {0, 2});
  EXPECT_EQ(f.scans(), 0u);
  EXPECT_TRUE(f.link->readings().empty());
  EXPECT_EQ(f.link->last_answer(), 7) << "the farm is there";
  EXPECT_FALSE(f.link->last_reading());
  f.now = 8;
  f.send_parts(2, {0, 1, 2});
  EXPECT_EQ(f.scans(), 1u);
  EXPECT_EQ(f.link->last_reading(), 8);
  f.expect_newest(2);
  EXPECT_EQ(f.link->counts().readings.lost, 1u);
  f.send_parts(1, {1});
  EXPECT_EQ(f.scans(), 1u) << "too late";
  EXPECT_EQ(f.link->counts().readings.late, 1u);
  f.expect_newest(2);
}

TEST(RobotLink, DuplicatePartsDoNotCreateAReading) {
  ScansInParts f;
  f.send_parts(1, {0, 0, 1, 1});
  EXPECT_EQ(f.scans(), 0u) << "four datagrams, two parts";
  EXPECT_EQ(f.link->counts().readings.duplicates, 2u);
  f.send_parts(1, {2, 2, 0});
  EXPECT_EQ(f.scans(), 1u);
  EXPECT_EQ(f.link->counts().stale, 1u) << "readings, not datagrams";
  f.expect_newest(1);
}

TEST(RobotLink, PartsOfReadingsArriveInAnyOrder) {
  ScansInParts f;
  f.send_parts(1, {2, 0});
  f.send_parts(2, {1});
  f.send_parts(1, {1});
  f.expect_newest(1);
  f.send_parts(3, {2, 1, 0});
  f.expect_newest(3);
  f.send_parts(2, {2, 0});
  EXPECT_EQ(f.scans(), 2u) << "an older one is dropped";
  f.expect_newest(3);
}

TEST(RobotLink, AReadingIsCompleteIfTheInjectedLinkLosesNoPart) {
  ScansInParts f(kLossy);
  std::uint64_t whole = 0;
  for (std::uint32_t sequence = 1; sequence <= 40; ++sequence) {
    std::uint64_t lost = 0;
    for (const std::uint64_t piece : {0, 1, 2}) lost += loses(kScans, piece << 32 | sequence);
    whole += lost == 0 ? 1 : 0;
    f.send_parts(sequence, {0, 1, 2});
    ASSERT_EQ(f.scans(), whole) << sequence;
  }
  EXPECT_GT(whole, 0u);
}

TEST(RobotLink, DelaysAndLosesPacketsAsTheInjectedLinkDoes) {
  PlayedFarm f(kLossy);
  std::uint64_t out = loses(stream_of(Type::subscribe, 0), 0), in = 0;
  for (std::uint32_t sequence = 0; sequence < 20; ++sequence) {
    f.link->send_state({}, 0);
    out += loses(stream_of(Type::v2v, 0), sequence);
    ASSERT_EQ(f.link->counts().out.lost, out) << sequence;
  }
  ASSERT_FALSE(f.received_types().empty());
  for (std::uint32_t sequence = 0; sequence < 20; ++sequence) {
    for (const auto other : {std::uint16_t{2}, std::uint16_t{3}}) {
      f.send({.robot = other, .sequence = sequence}, netio::V2v{});
      in += loses(stream_of(Type::v2v, 1), std::uint64_t{other} << 32 | sequence);
      ASSERT_EQ(f.link->counts().in.lost, in) << other << ", " << sequence;
    }
    f.send({.robot = 1}, netio::Start{});
    in += loses(stream_of(Type::start, 1), sequence);
    ASSERT_EQ(f.link->counts().in.lost, in) << sequence;
  }
}

TEST(RobotLink, LeavingSendsDelayedPacketsToo) {
  PlayedFarm f({.delay = 1.0});
  f.link->leave(0);
  EXPECT_TRUE(f.received_types().empty()) << "it has sent nothing";
  f.link->send_state({}, 0);
  EXPECT_TRUE(f.received_types().empty()) << "not due";
  f.link->leave(0);
  EXPECT_EQ(f.received_types(), (std::vector{Type::subscribe, Type::v2v, Type::leave}));
}

TEST(RobotLink, AnotherFarmHasAnotherClock) {
  PlayedFarm f;
  f.greet();
  f.send_scan(f.outbox, {.sequence = 1, .time = 100 * kSecond});
  EXPECT_EQ(f.link->clock().to_farm(0), 100 * kSecond);
  f.challenge(kPlayedFarm);
  EXPECT_EQ(f.link->clock().to_farm(0), 100 * kSecond) << "the same farm";
  f.challenge(kPlayedFarm + 1);
  EXPECT_FALSE(f.link->clock().synchronised());
  f.now = kSecond;
  f.send_scan(f.outbox, {.sequence = 1, .time = 3 * kSecond});
  EXPECT_EQ(f.link->clock().to_farm(0), 2 * kSecond);
}

}  // namespace
}  // namespace sf::server
