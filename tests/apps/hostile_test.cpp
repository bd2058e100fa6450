// `serve` with strangers that send well-formed but hostile datagrams over loopback, a limited number. A robot continues
// to be served, and no one without a proven address receives more than was sent in its name.

#include <gtest/gtest.h>

#include <random>

#include "netio/outbox.h"
#include "tests/apps/remote_robot.h"

namespace sf {

namespace {

constexpr std::size_t kStrangers = 20;  ///< number of sockets
constexpr int kRounds = 10;
constexpr int kEach = 20;  ///< datagrams per stranger and round

/// Sends arbitrary datagrams and counts the datagrams that it receives.
struct Stranger {
  netio::Outbox outbox;
  netio::Socket receiver;
  netio::ReceiveBatch batch{64};
  std::uint64_t sent = 0;      ///< [byte]
  std::uint64_t received = 0;  ///< [byte]

  Stranger() : Stranger(netio::open_udp({netio::kLoopback, 0})) {}
  explicit Stranger(netio::Socket socket) : outbox(netio::duplicate(socket)), receiver(std::move(socket)) {}
  void send(const netio::Endpoint& to, const base::Bytes& bytes) {
    outbox.queue(to, bytes);
    sent += bytes.size();
  }
  void receive() {
    while (const std::size_t count = batch.fill(receiver))
      for (std::size_t i = 0; i < count; ++i) received += batch.bytes(i).size();
  }
};

/// Returns one of the packets that anyone may send, for an existing robot.
base::Bytes anything(std::mt19937& generator) {
  const auto random = [&] { return static_cast<std::uint32_t>(generator()); };
  netio::Header header;
  header.robot = static_cast<std::uint16_t>(1 + random() % 2);
  header.sequence = random();
  header.time = random() % 2 == 0 ? netio::kMaxTime : 0;
  header.session = random();
  header.token = random() % 2 == 0 ? 0 : random();
  netio::V2v state;
  state.X_WR = {random() % 2 == 0 ? 1e7 : -1e7, 0.0, 1e7, 1e6};
  state.velocity = {1e3, -1e3, 1e3};
  base::Bytes bytes;
  switch (random() % 7) {
    case 0:
      netio::encode(header, netio::Subscribe{random()}, bytes);
      break;
    case 1:
      netio::encode(header, netio::Leave{}, bytes);
      break;
    case 2:
      header.robot = netio::kBroadcastId;
      netio::encode(header, netio::Start{}, bytes);
      break;
    case 3:
      netio::encode(header, netio::Challenge{header.token}, bytes);
      break;
    case 4:
      header.robot = 12;  // a tag that the world lacks
      netio::encode(header, netio::Tag{}, bytes);
      break;
    case 5:
      netio::encode_reading(header, 1, base::Bytes(netio::kMaxPayload, 1), bytes);
      break;
    default:
      netio::encode(header, state, bytes);
  }
  return bytes;
}

}  // namespace

TEST(Hostile, OneRobotIsServedAndNoOneIsFlooded) {
  Service service;
  ASSERT_NE(service.port, 0u) << service.program.err();
  const netio::Endpoint farm{netio::kLoopback, static_cast<std::uint16_t>(service.port)};
  const std::vector<double> expected = sensed(service.world, "roomba1", "-1,0.5,180");  // the other robot is behind it
  Robot one(1, service.port, service.laser_port(1)), two(2, service.port, service.laser_port(2));
  std::vector<Stranger> strangers(kStrangers);
  std::mt19937 random(11);  // NOLINT: the same every time

  const auto served = [&] {
    return until([&] {
      one.send_state({-1.0, 0.5, 0.0, M_PI});
      const std::vector<double> ranges = one.receive();
      bool same = ranges.size() == expected.size();
      for (std::size_t i = 0; same && i < ranges.size(); ++i) same = std::fabs(ranges[i] - expected[i]) <= 0.000501;
      return same;
    });
  };
  ASSERT_TRUE(served());
  for (int round = 0; round < kRounds; ++round) {
    for (Stranger& stranger : strangers) {
      for (int i = 0; i < kEach; ++i) stranger.send(farm, anything(random));
      stranger.outbox.flush();
    }
    // A valid robot that is as far away and as fast as a packet can express, and returns.
    two.send_state({round % 2 == 0 ? 1e7 : -1e7, 1e7, 0.0, -1e6});
    ASSERT_TRUE(served()) << round;
    for (Stranger& stranger : strangers) stranger.receive();
  }
  ASSERT_TRUE(service.program.running());
  const Outcome outcome = service.program.stop();
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_LT(count_lines(outcome.err), 10u + 30u) << outcome.err;  // a burst of 20, then 5 a second

  for (Stranger& stranger : strangers) {
    stranger.receive();
    EXPECT_GT(stranger.received, 0u) << "its address is challenged";
    EXPECT_LE(stranger.received, stranger.sent);
  }
  const Json facts(outcome.out);
  EXPECT_GT(facts.number("/received/unproven"), kRounds * static_cast<double>(kStrangers));
  EXPECT_GT(facts.number("/received/wrong direction"), 0);
  EXPECT_GT(facts.number("/received/unknown tag"), 0);
  EXPECT_FALSE(facts.has("/received/wrong source"));  // no stranger got this far
}

}  // namespace sf
