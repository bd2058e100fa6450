#include "netio/relay.h"

#include <gtest/gtest.h>

#include <map>
#include <numeric>

#include "netio/v2v_socket.h"
#include "tests/netio/examples.h"
#include "tests/units.h"

namespace sf::netio {
namespace {

/// A farm with three robots; each test sends for them.
struct RelayTest : testing::Test {
  Inbox inbox{{.bind = {kLoopback, 0}, .robots = {3, 7, 9}}};
  Relay relay{std::vector<std::uint32_t>{9, 3, 7}};
  Outbox outbox{inbox.socket()};
  std::vector<std::unique_ptr<V2vSocket>> radios;
  std::uint32_t sequence = 0;

  RelayTest() {
    for (const std::uint32_t id : {3u, 7u, 9u}) {
      V2vSocketOptions options{.farm = {kLoopback, inbox.port()}, .robot = id};
      for (const std::uint32_t other : {3u, 7u, 9u})
        if (other != id) options.others.push_back(other);
      radios.push_back(std::make_unique<V2vSocket>(options));
    }
    for (const std::uint32_t id : {3u, 7u, 9u}) prove(id);
  }
  V2vSocket& v2v_socket(std::uint32_t id) { return *radios[id == 3 ? 0 : id == 7 ? 1 : 2]; }

  /// Performs challenge and answer.
  void prove(std::uint32_t id) {
    base::Bytes answer;
    Packet packet;
    packet.header.session = v2v_socket(id).farm_session_token().token;
    ASSERT_TRUE(inbox.challenge(packet, {kLoopback, bound_endpoint(v2v_socket(id).socket()).port}, 0, answer));
    ASSERT_EQ(v2v_socket(id).accept(answer, 0, packet), PacketStatus::accepted);
  }
  void send_state(std::uint32_t id, double x) {
    base::Bytes bytes;
    encode({.robot = static_cast<std::uint16_t>(id), .sequence = sequence++}, V2v{.X_WR = {x, 0, 0, 0}}, bytes);
    v2v_socket(id).send(bytes);
    take();
  }
  void ask(std::uint32_t id, std::uint32_t types) {
    base::Bytes bytes;
    encode({.robot = static_cast<std::uint16_t>(id), .sequence = sequence++}, Subscribe{types}, bytes);
    v2v_socket(id).send(bytes);
    take();
  }
  void start(std::uint16_t id) {
    base::Bytes bytes;
    encode({.robot = id}, Start{}, bytes);
    v2v_socket(3).send(bytes);
    take();
  }
  void take() {
    std::size_t taken = 0;
    for (int visits = 0; taken == 0 && visits < 10'000'000; ++visits)
      taken = inbox.receive(0, [&](const Packet& packet) { relay.take(packet); });
  }
  void tick(std::int64_t now = 0) {
    relay.forward(inbox, now, outbox);
    outbox.flush();
  }
  /// Returns the packets received by a robot. Loopback delivers immediately.
  std::vector<Packet> received(std::uint32_t id, std::int64_t now = 0) {
    std::vector<Packet> packets;
    V2vSocket& one = v2v_socket(id);
    one.receive([&](std::span<const std::uint8_t> bytes) {
      Packet packet;
      if (one.accept(bytes, now, packet) == PacketStatus::accepted) packets.push_back(packet);
    });
    return packets;
  }
};

TEST_F(RelayTest, SendsStatesToSubscribers) {
  ask(3, kNeighboursBit);
  send_state(3, 1.0);
  send_state(7, 2.0);
  tick();
  const auto packets = received(3);
  ASSERT_EQ(packets.size(), 1u);  // excludes its own
  EXPECT_EQ(packets[0].header.robot, 7);
  EXPECT_EQ(std::get<V2v>(packets[0].body).X_WR.x, 2.0);
  EXPECT_TRUE(received(7).empty());  // not subscribed
  EXPECT_TRUE(received(9).empty());  // not active
  EXPECT_EQ(relay.counts().states, 1u);
}

TEST_F(RelayTest, SendsTheNewestStateOncePerTick) {
  ask(3, kNeighboursBit);
  for (const double x : {1.0, 2.0, 3.0}) send_state(7, x);
  send_state(9, 4.0);
  tick();
  auto packets = received(3);
  ASSERT_EQ(packets.size(), 2u);
  EXPECT_EQ(std::get<V2v>(packets[0].body).X_WR.x, 3.0);
  tick();  // no new states
  EXPECT_TRUE(received(3).empty());
  send_state(7, 5.0);
  tick();
  EXPECT_EQ(received(3).size(), 1u);
}

TEST_F(RelayTest, DropsStatesWithoutSubscribers) {
  send_state(7, 2.0);
  tick();
  ask(3, kNeighboursBit);
  tick();
  EXPECT_TRUE(received(3).empty());
}

TEST_F(RelayTest, SendsNothingToSilentRobots) {
  ask(3, kNeighboursBit);
  send_state(7, 2.0);
  start(kBroadcastId);
  tick(2 * kSecond);
  EXPECT_EQ(relay.counts().states + relay.counts().starts, 0u);
}

TEST_F(RelayTest, SendsStartToAllActiveRobots) {
  send_state(3, 0.0);
  send_state(7, 0.0);
  start(kBroadcastId);
  start(kBroadcastId);  // before the tick, sent once
  tick();
  for (const std::uint32_t id : {3u, 7u}) {
    const auto packets = received(id);
    ASSERT_EQ(packets.size(), 1u) << id;
    EXPECT_TRUE(std::holds_alternative<Start>(packets[0].body));
  }
  EXPECT_TRUE(received(9).empty());
  tick();
  EXPECT_TRUE(received(3).empty());  // once
}

TEST_F(RelayTest, StartMayAddressOneRobot) {
  send_state(3, 0.0);
  send_state(7, 0.0);
  start(7);
  tick();
  EXPECT_EQ(relay.counts().starts, 1u);
  EXPECT_TRUE(received(3).empty());
  EXPECT_EQ(received(7).size(), 1u);
  tick();
  EXPECT_TRUE(received(7).empty());  // once
}

TEST_F(RelayTest, ForwardsBytesUnchanged) {
  base::Bytes bytes;
  const V2v state{.X_WR = {1.5, -2.25, 0.0, 0.5}, .velocity = {0.25, 0.0, -0.125}, .follows = 3, .docking = true};
  encode({.robot = 7, .sequence = 77, .time = 1'500'000'000, .session = 5, .token = inbox.token({kLoopback, 1})}, state,
         bytes);
  Packet packet;
  ask(3, kNeighboursBit);
  ASSERT_EQ(inbox.accept(bytes, {kLoopback, 1}, 0, packet), PacketStatus::accepted);
  write_session_token(bytes, v2v_socket(3).farm_session_token());  // except for sender and receiver
  relay.take(packet);
  tick();
  base::Bytes arrived;
  v2v_socket(3).receive([&](std::span<const std::uint8_t> got) { arrived.assign(got.begin(), got.end()); });
  EXPECT_EQ(arrived, bytes);
}

/// Receivers of earlier versions know one length of the states in NEIGHBOURS.
TEST_F(RelayTest, ForwardsTiltedRobotsAsLevel) {
  Packet packet;
  ask(3, kNeighboursBit);
  ASSERT_EQ(decode(tilted_v2v_example(), packet), PacketStatus::accepted);
  relay.take(packet);
  tick();
  base::Bytes arrived;
  v2v_socket(3).receive([&](std::span<const std::uint8_t> got) { arrived.assign(got.begin(), got.end()); });
  EXPECT_EQ(arrived.size(), kV2vBytes);
  ASSERT_EQ(decode(arrived, packet), PacketStatus::accepted);
  EXPECT_EQ(std::get<V2v>(packet.body).X_WR.z, 0.75);
}

TEST_F(RelayTest, DoesNotForwardTagsAndRequests) {
  ask(3, kNeighboursBit);
  Packet packet;
  decode(tag_example(), packet);
  relay.take(packet);
  decode(subscribe_example(), packet);
  relay.take(packet);
  tick();
  EXPECT_EQ(relay.counts().states + relay.counts().starts, 0u);
}

constexpr std::uint32_t kRelayFarm = 0xFA23;  ///< session
constexpr std::uint32_t kRelayOwn = 0x0707;   ///< session

struct V2vSocketTest : testing::Test {
  Outbox farm{OutboxOptions{.bind = {kLoopback, 0}}};
  V2vSocket v2v_socket{{.farm = farm.endpoint(), .robot = 7, .others = {3, 9}, .session = kRelayOwn}};
  Packet packet;
  V2vSocketTest() {
    base::Bytes bytes;
    encode({.session = kRelayFarm, .token = kRelayOwn}, Challenge{3}, bytes);
    v2v_socket.accept(bytes, 0, packet);
  }
  Endpoint to() const { return {kLoopback, bound_endpoint(v2v_socket.socket()).port}; }
};

base::Bytes v2v_of(std::uint16_t robot, std::uint32_t sequence) {
  base::Bytes bytes;
  encode({.robot = robot, .sequence = sequence, .session = kRelayFarm, .token = kRelayOwn}, V2v{}, bytes);
  return bytes;
}

base::Bytes stamped(base::Bytes bytes, const SessionToken& stamp = {kRelayFarm, kRelayOwn}) {
  netio::write_session_token(bytes, stamp);
  return bytes;
}

TEST_F(V2vSocketTest, AcceptsOnlyPacketsFromTheFarm) {
  Outbox stranger;
  stranger.queue(to(), v2v_of(3, 0));
  stranger.flush();
  farm.queue(to(), v2v_of(3, 0));
  farm.flush();
  int arrived = 0;
  v2v_socket.receive([&](std::span<const std::uint8_t> bytes) {
    ++arrived;
    EXPECT_EQ(v2v_socket.accept(bytes, 0, packet), PacketStatus::accepted);
  });
  EXPECT_EQ(arrived, 1);
  EXPECT_EQ(v2v_socket.counts()[PacketStatus::wrong_source], 1u);
}

/// Each of its states is checked separately.
TEST_F(V2vSocketTest, SplitsNeighbours) {
  base::Bytes states, bytes;
  for (const base::Bytes& state : {v2v_of(3, 5), v2v_of(9, 0), v2v_of(3, 4), stamped(v2v_of(9, 1), {})})
    states.insert(states.end(), state.begin(), state.end());
  encode({.robot = 7, .session = kRelayFarm, .token = kRelayOwn}, Neighbours{states}, bytes);
  farm.queue(to(), bytes);
  farm.queue(to(), stamped(start_example()));
  farm.flush();
  std::vector<PacketStatus> reasons;
  v2v_socket.receive([&](std::span<const std::uint8_t> one) { reasons.push_back(v2v_socket.accept(one, 0, packet)); });
  EXPECT_EQ(reasons, (std::vector{PacketStatus::accepted, PacketStatus::accepted, PacketStatus::stale,
                                  PacketStatus::wrong_source, PacketStatus::accepted}));
  EXPECT_EQ(v2v_socket.accept(bytes, 0, packet), PacketStatus::wrong_direction) << "NEIGHBOURS must be split first";
}

TEST_F(V2vSocketTest, ChecksReceivedPackets) {
  EXPECT_EQ(v2v_socket.accept(v2v_of(3, 5), 0, packet), PacketStatus::accepted);
  EXPECT_EQ(v2v_socket.accept(v2v_of(3, 5), 0, packet), PacketStatus::stale);
  EXPECT_EQ(v2v_socket.accept(v2v_of(7, 0), 0, packet), PacketStatus::unknown_robot);  // itself
  EXPECT_EQ(v2v_socket.accept(v2v_of(8, 0), 0, packet), PacketStatus::unknown_robot);
  EXPECT_EQ(v2v_socket.accept(stamped(start_example()), 0, packet), PacketStatus::accepted);
  EXPECT_EQ(v2v_socket.accept(stamped(patched<std::uint16_t>(start_example(), 6, 7)), 0, packet),
            PacketStatus::accepted);
  EXPECT_EQ(v2v_socket.accept(stamped(patched<std::uint16_t>(start_example(), 6, 3)), 0, packet),
            PacketStatus::unknown_robot);
  EXPECT_EQ(v2v_socket.accept(stamped(reading_example()), 0, packet), PacketStatus::wrong_direction);
  EXPECT_EQ(v2v_socket.accept(stamped(subscribe_example()), 0, packet), PacketStatus::wrong_direction);
  EXPECT_EQ(v2v_socket.accept(base::Bytes(5), 0, packet), PacketStatus::too_short);
  EXPECT_TRUE(v2v_socket.is_active(3, 2 * kSecond - 1));
  EXPECT_FALSE(v2v_socket.is_active(3, 2 * kSecond));
  EXPECT_FALSE(v2v_socket.is_active(9, 0));
  EXPECT_EQ(v2v_socket.counts().total(), 11u);
}

/// A forger of the farm's address has to guess the session.
TEST_F(V2vSocketTest, AcceptsOnlyPacketsWithItsSession) {
  const auto challenge = [](std::uint32_t token, const SessionToken& stamp) {
    base::Bytes bytes;
    encode({.session = stamp.session, .token = stamp.token}, Challenge{token}, bytes);
    return bytes;
  };
  EXPECT_EQ(v2v_socket.accept(stamped(v2v_of(3, 0), {kRelayFarm, kRelayOwn + 1}), 0, packet),
            PacketStatus::wrong_source);
  EXPECT_EQ(v2v_socket.accept(stamped(v2v_of(3, 0), {kRelayFarm + 1, kRelayOwn}), 0, packet),
            PacketStatus::wrong_source);
  EXPECT_EQ(v2v_socket.accept(stamped(start_example(), {}), 0, packet), PacketStatus::wrong_source);
  EXPECT_EQ(v2v_socket.accept(challenge(9, {kRelayFarm + 1, 0}), 0, packet), PacketStatus::wrong_source);
  EXPECT_EQ(v2v_socket.farm_session_token().session, kRelayFarm);
  // A restarted farm has another session, and packets of the old session are stale.
  EXPECT_EQ(v2v_socket.accept(challenge(9, {kRelayFarm + 1, kRelayOwn}), 0, packet), PacketStatus::accepted);
  EXPECT_EQ(v2v_socket.farm_session_token().session, kRelayFarm + 1);
  EXPECT_EQ(v2v_socket.accept(v2v_of(3, 0), 0, packet), PacketStatus::wrong_source);
  EXPECT_EQ(v2v_socket.accept(stamped(v2v_of(3, 0), {kRelayFarm + 1, kRelayOwn}), 0, packet), PacketStatus::accepted);
}

TEST_F(V2vSocketTest, SendsWithTheNewestToken) {
  const Socket sink = open_udp({kLoopback, 0});
  V2vSocket client({.farm = {kLoopback, bound_endpoint(sink).port}, .robot = 7, .others = {}, .session = kRelayOwn});
  ReceiveBatch batch(1);
  for (const std::uint32_t token : {0u, 9u, 10u}) {
    base::Bytes bytes;
    encode({.session = kRelayFarm, .token = kRelayOwn}, Challenge{token}, bytes);
    if (token != 0) {
      ASSERT_EQ(client.accept(bytes, 0, packet), PacketStatus::accepted);
    }
    client.send(v2v_example());
    while (batch.fill(sink) == 0) wait_readable(sink, sink, 1000);
    ASSERT_EQ(decode(batch.bytes(0), packet), PacketStatus::accepted);
    EXPECT_EQ(packet.header.session, kRelayOwn);
    EXPECT_EQ(packet.header.token, token);
  }
}

/// A farm with a control centre, whose address the peers permit.
struct CentreTest : testing::Test {
  static constexpr Peer kPermitted{PeerKind::centre, 0, kLoopback, std::nullopt};
  Inbox inbox{{.bind = {kLoopback, 0}, .robots = {3, 7, kMaxId}, .peers = {kPermitted}}};
  Relay relay{std::vector<std::uint32_t>{3, 7, kMaxId}, {.range = 0.0, .budget = 4}};
  Socket socket = open_udp({kLoopback, 0}, {});
  Endpoint self{kLoopback, bound_endpoint(socket).port};
  Outbox outbox{inbox.socket()};
  std::uint32_t sequence = 0;

  PacketStatus send(Type type, std::uint16_t sensor, std::uint32_t token, std::int64_t now = 0,
                    std::uint32_t address = kLoopback) {
    base::Bytes bytes;
    const Header header{.robot = kBroadcastId, .sensor = sensor, .sequence = sequence++, .session = 5, .token = token};
    type == Type::leave ? encode(header, Leave{}, bytes) : encode(header, Subscribe{kNeighboursBit}, bytes);
    Packet packet;
    return inbox.accept(bytes, {address, self.port}, now, packet);
  }
  void state(std::uint32_t id, double x) {
    relay.take({.header = {.type = Type::v2v, .robot = static_cast<std::uint16_t>(id)}, .body = V2v{.X_WR = {x}}});
  }
  /// Returns the states that arrive, per datagram.
  std::vector<std::vector<double>> tick(std::int64_t now = 0) {
    relay.forward(inbox, now, outbox);
    outbox.flush();
    std::vector<std::vector<double>> all;
    ReceiveBatch batch(8);
    batch.drain(socket, 64, [&](std::span<const std::uint8_t> bytes, const Endpoint&) {
      Packet packet;
      EXPECT_EQ(decode(bytes, packet), PacketStatus::accepted);
      EXPECT_EQ(packet.header.robot, kBroadcastId);
      EXPECT_EQ(packet.header.token, 5u);
      std::vector<double>& states = all.emplace_back();
      const std::span<const std::uint8_t> rows = std::get<Neighbours>(packet.body).states;
      for (std::size_t at = 0; at < rows.size(); at += kV2vBytes) {
        Packet row;
        EXPECT_EQ(decode(rows.subspan(at, kV2vBytes), row), PacketStatus::accepted);
        states.push_back(std::get<V2v>(row.body).X_WR.x);
      }
    });
    return all;
  }
};

using Datagrams = std::vector<std::vector<double>>;

TEST_F(CentreTest, ReceivesTheStatesOfAllRobotsBeyondTheRange) {
  state(3, 1.0), state(7, 9e5);
  EXPECT_EQ(tick(), Datagrams{}) << "it has not asked";
  EXPECT_EQ(send(Type::subscribe, kCentre, 1), PacketStatus::unproven) << "without the token of its address";
  EXPECT_EQ(tick(), Datagrams{});
  ASSERT_EQ(send(Type::subscribe, kCentre, inbox.token(self)), PacketStatus::accepted);
  state(3, 2.0), state(7, 9e5);
  EXPECT_EQ(tick(), (Datagrams{{2.0, 9e5}}));
  EXPECT_EQ(tick(), Datagrams{}) << "each state once";
  EXPECT_EQ(relay.counts().centre, 2u);
  state(7, 3.0);
  EXPECT_EQ(tick(3 * kSecond), Datagrams{}) << "it fell silent";
}

TEST_F(CentreTest, OnlyThePermittedAddress) {
  EXPECT_EQ(send(Type::subscribe, kCentre, inbox.token({kLoopback + 1, self.port}), 0, kLoopback + 1),
            PacketStatus::wrong_source);
  Inbox closed{{.bind = {kLoopback, 0}, .robots = {3}}};
  base::Bytes bytes;
  encode({.robot = kBroadcastId, .sensor = kCentre, .token = closed.token(self)}, Subscribe{}, bytes);
  Packet packet;
  EXPECT_EQ(closed.accept(bytes, self, 0, packet), PacketStatus::unknown_robot) << "without a permission";
  EXPECT_FALSE(closed.centre_address(0));
}

TEST_F(CentreTest, LeavesAndIsNotTheRobotOfItsNumber) {
  ASSERT_EQ(send(Type::subscribe, kCentre, inbox.token(self)), PacketStatus::accepted);
  EXPECT_FALSE(inbox.is_active(kMaxId, 0));
  EXPECT_TRUE(inbox.centre_address(0));
  EXPECT_EQ(send(Type::leave, kCentre, inbox.token(self)), PacketStatus::accepted);
  EXPECT_FALSE(inbox.centre_address(0));
  EXPECT_EQ(send(Type::subscribe, 0, inbox.token(self)), PacketStatus::accepted) << "the robot";
  EXPECT_TRUE(inbox.is_active(kMaxId, 0));
  EXPECT_FALSE(inbox.centre_address(0));
}

/// More robots than a tick's budget take turns.
TEST(Centre, StatesBeyondTheBudgetAreCountedAndTakeTurns) {
  std::vector<std::uint32_t> ids(10);
  std::iota(ids.begin(), ids.end(), 1u);
  Inbox inbox{{.bind = {kLoopback, 0}, .robots = ids, .peers = {CentreTest::kPermitted}}};
  Relay relay{ids, {.budget = 4}};
  Outbox outbox{inbox.socket()};
  const Socket socket = open_udp({kLoopback, 0}, {});
  const Endpoint self{kLoopback, bound_endpoint(socket).port};
  base::Bytes bytes;
  Packet packet;
  encode({.robot = kBroadcastId, .sensor = kCentre, .token = inbox.token(self)}, Subscribe{}, bytes);
  ASSERT_EQ(inbox.accept(bytes, self, 0, packet), PacketStatus::accepted);
  for (int tick = 0; tick < 5; ++tick) {
    for (const std::uint32_t id : ids)
      relay.take({.header = {.type = Type::v2v, .robot = static_cast<std::uint16_t>(id)}, .body = V2v{}});
    relay.forward(inbox, 0, outbox);
    outbox.flush();
  }
  EXPECT_EQ(relay.counts().centre, 20u);
  EXPECT_EQ(relay.counts().missed, 30u);
  std::map<std::uint32_t, int> received;
  ReceiveBatch batch(8);
  batch.drain(socket, 64, [&](std::span<const std::uint8_t> datagram, const Endpoint&) {
    EXPECT_EQ(decode(datagram, packet), PacketStatus::accepted);
    const base::Bytes rows(std::get<Neighbours>(packet.body).states.begin(),
                           std::get<Neighbours>(packet.body).states.end());
    for (std::size_t at = 0; at < rows.size(); at += kV2vBytes) {
      Packet row;
      EXPECT_EQ(decode(std::span(rows).subspan(at, kV2vBytes), row), PacketStatus::accepted);
      ++received[row.header.robot];
    }
  });
  ASSERT_EQ(received.size(), 10u);
  for (const auto& [id, count] : received) EXPECT_EQ(count, 2) << id;
}

}  // namespace
}  // namespace sf::netio
