#pragma once
// A fleet behind a relay: all its robots send and receive on one socket.

#include <gtest/gtest.h>

#include <map>
#include <numeric>
#include <vector>

#include "netio/relay.h"
#include "netio/socket.h"
#include "netio/v2v_socket.h"

namespace sf::netio::test {

constexpr std::uint32_t kFarm = 0xFA23;    ///< session
constexpr std::uint32_t kRobots = 0x0707;  ///< session

struct RelayFixture {
  std::vector<std::uint32_t> ids;  ///< 0, 1, ...
  Inbox inbox;
  Relay relay;
  Outbox outbox{OutboxOptions{.bind = {kLoopback, 0}}};
  Socket socket = open_udp({kLoopback, 0});
  Endpoint where{kLoopback, bound_endpoint(socket).port};
  ReceiveBatch batch{64};
  std::uint32_t sequence = 0;
  std::vector<base::Bytes> datagrams;  ///< of the last `received`

  /// @param lights ids of intersections
  explicit RelayFixture(std::uint32_t count, const RelayOptions& options = {},
                        const std::vector<std::uint32_t>& lights = {})
      : ids(first(count)),
        inbox({.bind = {kLoopback, 0}, .robots = ids, .session = kFarm, .lights = lights}),
        relay(ids, options, lights) {}
  static std::vector<std::uint32_t> first(std::uint32_t count) {
    std::vector<std::uint32_t> all(count);
    std::iota(all.begin(), all.end(), 0u);
    return all;
  }

  template <class Body>
  void take(std::uint32_t id, const Body& body) {
    base::Bytes bytes;
    encode({.robot = static_cast<std::uint16_t>(id), .sequence = sequence++, .session = kRobots}, body, bytes);
    write_session_token(bytes, {kRobots, inbox.token(where)});
    Packet packet;
    ASSERT_EQ(inbox.accept(bytes, where, 0, packet), PacketStatus::accepted);
    relay.take(packet);
  }
  void send(std::uint32_t id, glm::dvec2 p) { take(id, V2v{.X_WR = {p.x, p.y, 0, 0}}); }
  void ask(std::uint32_t id, std::uint32_t types = kNeighboursBit) { take(id, Subscribe{types}); }
  /// Sends a light's position.
  void shine(std::uint32_t light, glm::dvec2 p) {
    base::Bytes rows;
    put(SignalApproach{.X_WL = {p.x, p.y, 0, 0}}, rows);
    take(light, V2i{rows, {}});
  }
  void all_ask() {
    for (const std::uint32_t id : ids) ask(id);
  }

  /// Runs one tick. @return its additions to the counts
  RelayCounts pass(std::int64_t now = 0) {
    const RelayCounts before = relay.counts();
    relay.forward(inbox, now, outbox);
    outbox.flush();
    const RelayCounts& after = relay.counts();
    return {after.states - before.states, after.datagrams - before.datagrams, after.waited - before.waited,
            after.starts - before.starts};
  }

  /// Returns the ids of the received states, in order, by robot or light. Loopback delivers immediately.
  std::map<std::uint32_t, std::vector<std::uint32_t>> received() {
    std::map<std::uint32_t, std::vector<std::uint32_t>> received;
    datagrams.clear();
    while (const std::size_t count = batch.fill(socket)) {
      for (std::size_t i = 0; i < count; ++i) {
        datagrams.emplace_back(batch.bytes(i).begin(), batch.bytes(i).end());
        Packet whole;
        EXPECT_EQ(decode(batch.bytes(i), whole), PacketStatus::accepted);
        EXPECT_EQ(whole.header.type, Type::neighbours);
        V2vSocket::for_each_state(batch.bytes(i), [&](std::span<const std::uint8_t> state) {
          Packet packet;
          EXPECT_EQ(decode(state, packet), PacketStatus::accepted);
          received[whole.header.robot].push_back(packet.header.robot);
        });
      }
    }
    return received;
  }
};

}  // namespace sf::netio::test
