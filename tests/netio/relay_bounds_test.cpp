// Forwards states within the V2V range and a budget for any number of subscribers. Counts the work, without a clock.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "tests/netio/relay_fixture.h"

namespace sf::netio {
namespace {

using test::RelayFixture;
using Rows = std::vector<std::uint32_t>;

TEST(RelayBounds, ForwardsStatesWithinRange) {
  RelayFixture crowd(4, {.range = 10.0});
  crowd.all_ask();
  crowd.send(0, {0, 0});
  crowd.send(1, {6, 8});                         // exactly at the range
  crowd.send(2, {-6, -std::nextafter(8.0, 9)});  // the next double beyond
  crowd.send(3, {1000, 0});
  EXPECT_EQ(crowd.pass().states, 2u);
  auto received_states = crowd.received();
  EXPECT_EQ(received_states[0], Rows{1});
  EXPECT_EQ(received_states[1], Rows{0});
  // A robot without a new state keeps its position; its old state is not forwarded.
  crowd.send(1, {6, 8});
  crowd.pass();
  received_states = crowd.received();
  EXPECT_EQ(received_states.size(), 1u);
  EXPECT_EQ(received_states[0], Rows{1});
}

TEST(RelayBounds, RangeOfZeroForwardsNothing) {
  RelayFixture crowd(3, {.range = 0.0});
  crowd.all_ask();
  for (const std::uint32_t id : {1u, 2u}) crowd.send(id, {0, 0});  // at one place; robot 0 without one
  crowd.take(kBroadcastId, Start{});
  const RelayCounts counts = crowd.pass();
  EXPECT_EQ(counts.states + counts.waited, 0u);
  EXPECT_EQ(counts.starts, 3u) << "no V2V";
}

TEST(RelayBounds, RobotWithoutAPositionReceivesAllInTurn) {
  RelayFixture crowd(13, {.range = 10.0, .most = Relay::kMinShare});
  crowd.ask(0);
  std::set<std::uint32_t> received_states;
  for (int pass = 0; pass < 3; ++pass) {
    for (std::uint32_t id = 1; id < 13; ++id) crowd.send(id, {1000.0 * id, 0});
    EXPECT_EQ(crowd.pass().states, 4u);
    const Rows states = crowd.received()[0];
    received_states.insert(states.begin(), states.end());
  }
  EXPECT_EQ(received_states.size(), 12u);
}

TEST(RelayBounds, PacksStatesNearestFirst) {
  for (const std::uint32_t others : {1u, 9u, 10u, 80u}) {  // one, a full datagram, one more, more than the maximum
    RelayFixture crowd(others + 1);
    crowd.ask(0);
    Rows nearest;
    for (std::uint32_t id = 0; id <= others; ++id) crowd.send(id, {0.1 * id, 0});
    for (std::uint32_t id = 1; id <= std::min(others, 64u); ++id) nearest.push_back(id);
    const RelayCounts counts = crowd.pass();
    EXPECT_EQ(counts.states, nearest.size());
    EXPECT_EQ(counts.datagrams, (nearest.size() + 8) / 9);
    EXPECT_EQ(crowd.received()[0], nearest);
    for (const base::Bytes& bytes : crowd.datagrams) EXPECT_LE(bytes.size(), kMaxDatagram - kMaxTrailer);
  }
}

TEST(RelayBounds, ForwardedPacketsCarryTheReceiversSession) {
  RelayFixture crowd(12);
  crowd.ask(5);
  for (const std::uint32_t id : crowd.ids) crowd.send(id, {0, 0});
  for (std::uint32_t pass = 0, next = 0; pass < 2; ++pass) {
    crowd.send(0, {0, 0});
    crowd.pass(1000 + pass);
    crowd.received();
    for (const base::Bytes& bytes : crowd.datagrams) {
      Packet packet;
      decode(bytes, packet);
      EXPECT_EQ(packet.header.robot, 5);
      EXPECT_EQ(packet.header.time, 1000 + pass) << "the farm's time";
      EXPECT_EQ(packet.header.sequence, next++) << "counts datagrams to this robot";
      const auto carries_it = [&](std::span<const std::uint8_t> one) {
        decode(one, packet);
        EXPECT_EQ(packet.header.session, test::kFarm);
        EXPECT_EQ(packet.header.token, test::kRobots);
      };
      carries_it(bytes);
      V2vSocket::for_each_state(bytes, carries_it);
    }
    EXPECT_EQ(next, 2u + pass);
  }
}

/// 500 and 1000 subscribers behind one socket, side by side or all at the origin for lack of a position: sent states
/// and visits grow with their number, not with its square.
TEST(RelayBounds, BudgetHoldsForAnyNumberOfSubscribers) {
  for (const bool localised : {true, false}) {
    for (const std::uint32_t count : {500u, 1000u}) {
      RelayFixture crowd(count);
      crowd.all_ask();
      for (const std::uint32_t id : crowd.ids)
        crowd.send(id, localised ? glm::dvec2{0.3 * (id % 32), 0.3 * (id / 32)} : glm::dvec2{});
      const RelayCounts counts = crowd.pass();
      const std::size_t share = 16'384 / count;  // 32, and 16
      EXPECT_EQ(counts.states, count * share);
      EXPECT_EQ(counts.datagrams, count * ((share + 8) / 9));
      EXPECT_EQ(counts.waited, 0u);
      EXPECT_LE(crowd.relay.visits(), 8 * count * share) << "of " << count * (count - 1);
    }
  }
}

/// A budget for ten of thirty: all get a turn within three ticks, in order, and none gets two before all have had one.
TEST(RelayBounds, RobotsTakeTurnsWhenTheBudgetIsSpent) {
  RelayFixture crowd(30, {.budget = 10 * Relay::kMinShare});
  crowd.all_ask();
  for (std::uint32_t pass = 0; pass < 6; ++pass) {
    for (const std::uint32_t id : crowd.ids) crowd.send(id, {0.1 * id, 0});
    const RelayCounts counts = crowd.pass();
    EXPECT_EQ(counts.states, 40u);
    EXPECT_EQ(counts.waited, 20u);
    std::uint32_t next = pass % 3 * 10;
    for (const auto& [id, states] : crowd.received()) {
      EXPECT_EQ(id, next++) << pass;
      EXPECT_EQ(states.size(), 4u);
    }
    EXPECT_EQ(next, pass % 3 * 10 + 10);
  }
}

/// A robot that unsubscribes before its turn is skipped.
TEST(RelayBounds, UnusedTurnPassesToTheNextRobot) {
  RelayFixture crowd(4, {.budget = Relay::kMinShare});
  crowd.all_ask();
  const auto served = [&] {
    for (const std::uint32_t id : crowd.ids) crowd.send(id, {0.1 * id, 0});
    crowd.pass();
    const auto received_states = crowd.received();
    return received_states.size() == 1 ? received_states.begin()->first : kNone;
  };
  EXPECT_EQ(served(), 0u);
  crowd.ask(1, 1u << 1);
  EXPECT_EQ(served(), 2u);
  EXPECT_EQ(served(), 3u);
  EXPECT_EQ(served(), 0u);
}

/// Five robots that send, subscribe and unsubscribe at random, with a budget for one or two: each robot receives all
/// states since its last turn or subscription, once, and waits for at most four others.
TEST(RelayBounds, TurnIncludesAllStatesSinceTheLastTurn) {
  RelayFixture crowd(5, {.budget = Relay::kMinShare});
  std::mt19937 random(3);  // NOLINT: the same every time
  std::vector<std::set<std::uint32_t>> due(5);
  std::vector<int> waits(5, 0);
  for (int pass = 0; pass < 400; ++pass) {
    std::set<std::uint32_t> spoke;
    for (const std::uint32_t id : crowd.ids)
      if (random() % 3 == 0) crowd.send(id, {0, 0}), spoke.insert(id);
    for (const std::uint32_t id : crowd.ids) {
      const bool asks = random() % 8 != 0;
      crowd.ask(id, asks ? kNeighboursBit : 1u << 1);
      if (asks) due[id].insert(spoke.begin(), spoke.end());
      if (!asks) due[id].clear();
      due[id].erase(id);
    }
    crowd.pass();
    auto received_states = crowd.received();
    for (const std::uint32_t id : crowd.ids) {
      const Rows arrived = received_states[id];
      waits[id] = arrived.empty() && !due[id].empty() ? waits[id] + 1 : 0;
      EXPECT_LE(waits[id], 4);
      if (arrived.empty()) continue;
      EXPECT_EQ(arrived, Rows(due[id].begin(), due[id].end())) << id << " in pass " << pass;
      due[id].clear();
    }
  }
}

constexpr std::uint32_t kNorth = 100, kSouth = 101;  ///< lights

TEST(RelayBounds, LightsReceiveRobotsWithinRange) {
  RelayFixture crowd(3, {.range = 10.0}, {kNorth, kSouth});
  crowd.shine(kNorth, {0, 100});
  crowd.shine(kSouth, {0, -100});
  crowd.send(0, {0, 90});  // exactly at the range
  crowd.send(1, {0, std::nextafter(-90.0, 0)});
  crowd.send(2, {0, -95});
  crowd.pass();  // no robot has subscribed
  const auto received_states = crowd.received();
  EXPECT_EQ(received_states, (std::map<std::uint32_t, Rows>{{kNorth, {0}}, {kSouth, {2}}}));
}

/// Independent of the budget left to robots, and once, even if others wait for the same states.
TEST(RelayBounds, LightReceivesTheNearestInTheSameTick) {
  RelayFixture crowd(70, {.budget = Relay::kMinShare}, {kNorth});
  crowd.all_ask();
  crowd.shine(kNorth, {0, 0});
  Rows nearest(64);
  std::iota(nearest.begin(), nearest.end(), 0u);
  for (const std::uint32_t id : crowd.ids) crowd.send(id, {0.1 * id, 0});
  crowd.pass();
  EXPECT_EQ(crowd.received()[kNorth], nearest);
  crowd.send(9, {0, 0});
  EXPECT_GT(crowd.pass().waited, 0u);
  EXPECT_EQ(crowd.received()[kNorth], Rows{9});
}

TEST(RelayBounds, TurnHoldsAtLeastFourStates) {
  const Rows ids{0, 1};
  EXPECT_DEATH(Relay(ids, {.most = Relay::kMinShare - 1}), "without a receiver");
  EXPECT_DEATH(Relay(ids, {.budget = Relay::kMinShare - 1}), "without a receiver");
}

/// Robots with few neighbours use little of the budget, so more than two are served.
TEST(RelayBounds, UnusedSharesServeOtherRobots) {
  RelayFixture crowd(8, {.range = 1.0, .budget = 2 * Relay::kMinShare});
  crowd.all_ask();
  for (const std::uint32_t id : crowd.ids) crowd.send(id, {100.0 * (id / 2), 0});  // in pairs
  const RelayCounts counts = crowd.pass();
  EXPECT_GE(counts.states, 5u);
  EXPECT_LE(counts.waited, 3u);
}

}  // namespace
}  // namespace sf::netio
