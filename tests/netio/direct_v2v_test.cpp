// V2V without the farm, over loopback, on the test's own clock.

#include "netio/direct_v2v.h"

#include <gtest/gtest.h>

#include <functional>
#include <memory>

#include "tests/netio/log_pipe.h"
#include "tests/refusal.h"
#include "tests/units.h"

namespace sf::netio {
namespace {

constexpr SigningKey kSecondKey{2}, kThirdKey{3}, kGroupKey{9};
constexpr std::uint32_t kSecondSession = 0x2222;
constexpr std::int64_t kDirectSecond = 1'000'000'000;  ///< [ns]

base::Bytes direct_state(std::uint16_t robot, std::uint32_t sequence, double x = 1.0,
                         std::uint32_t session = kSecondSession) {
  base::Bytes out;
  encode({.robot = robot, .sequence = sequence, .session = session}, V2v{.X_WR = {x, 0, 0, 0}}, out);
  return out;
}

/// Robot 1 at the origin, in a world with robots 1, 2 and 3.
struct DirectV2vTest : testing::Test {
  LogPipe log;
  std::unique_ptr<DirectV2v> one = make({});
  Outbox second{OutboxOptions{.bind = {kLoopback, 0}}}, elsewhere{OutboxOptions{.bind = {kLoopback, 0}}};
  std::int64_t now = 0;

  std::unique_ptr<DirectV2v> make(const std::vector<Peer>& table, double radio = kV2vRange) {
    auto made = std::make_unique<DirectV2v>(DirectV2vOptions{.bind = {kLoopback, 0},
                                                             .radio = radio,
                                                             .robot = 1,
                                                             .others = {3, 2},
                                                             .table = table,
                                                             .session = 0x1111,
                                                             .log_descriptor = log.descriptor()});
    made->set_position({0.0, 0.0});
    return made;
  }
  /// Sends a datagram to robot 1. @return the number of new states
  int feed(const base::Bytes& bytes, Outbox& from) {
    from.queue({kLoopback, one->port()}, bytes);
    from.flush();
    int states = 0;
    one->receive(now, [&](std::span<const std::uint8_t> received) {
      Packet packet;
      ASSERT_EQ(decode(received, packet), PacketStatus::accepted);
      states += one->admit(packet.header, now) ? 1 : 0;
    });
    return states;
  }
  int feed(const base::Bytes& bytes) { return feed(bytes, second); }
  std::uint64_t count(PacketStatus status) const { return one->counts().packets[status]; }
};

base::Bytes signed_with(PacketSigner& signer, base::Bytes bytes) {
  signer.sign(bytes);
  return bytes;
}

TEST_F(DirectV2vTest, NewStatesOfOtherRobotsAreAccepted) {
  EXPECT_EQ(feed(direct_state(2, 0)), 1);
  EXPECT_TRUE(one->is_active(2, now));
  EXPECT_FALSE(one->is_active(3, now));
  EXPECT_EQ(feed(direct_state(2, 1)), 1);
  EXPECT_EQ(feed(direct_state(2, 0)), 0) << "overtaken";
  EXPECT_EQ(count(PacketStatus::accepted), 2u);
  EXPECT_EQ(count(PacketStatus::stale), 1u);
  now = 3 * kDirectSecond;
  EXPECT_FALSE(one->is_active(2, now));
}

TEST_F(DirectV2vTest, OtherPacketsAreCountedOneByOne) {
  EXPECT_EQ(feed(direct_state(1, 0, 1.0, 0x1111)), 0) << "its own packet, returned by the network";
  EXPECT_EQ(one->counts().own, 1u);
  EXPECT_EQ(feed(direct_state(1, 0)), 0) << "another process with its id";
  EXPECT_EQ(count(PacketStatus::wrong_source), 1u);
  EXPECT_EQ(feed(direct_state(4, 0)), 0);
  EXPECT_EQ(count(PacketStatus::unknown_robot), 1u);
  base::Bytes leave;
  encode({.robot = 2, .session = kSecondSession}, Leave{}, leave);
  EXPECT_EQ(feed(leave), 0);
  EXPECT_EQ(count(PacketStatus::wrong_direction), 1u);
  base::Bytes cut = direct_state(2, 0);
  cut.pop_back();
  EXPECT_EQ(feed(cut), 0);
  EXPECT_EQ(count(PacketStatus::too_short), 1u);
  EXPECT_EQ(one->counts().packets.total(), 4u);
  const std::string text = log.read_all();
  EXPECT_NE(text.find("no robot with id 4"), std::string::npos) << text;
  EXPECT_NE(text.find("a V2V of 131 bytes is too short"), std::string::npos) << text;
}

/// The range is inclusive, as the farm's. Heights do not count.
TEST_F(DirectV2vTest, RobotsBeyondRadioRangeAreIgnored) {
  one = make({}, 10.0);
  EXPECT_EQ(feed(direct_state(2, 0, 10.0)), 1);
  EXPECT_EQ(feed(direct_state(2, 1, 10.001)), 0);
  EXPECT_EQ(one->counts().far, 1u);
  EXPECT_EQ(feed(direct_state(3, 0, -10.001)), 0);
  EXPECT_FALSE(one->is_active(3, now)) << "it has no state, so it must not become an obstacle";
  one->set_position({1.0, 0.0});
  EXPECT_EQ(feed(direct_state(2, 2, 10.001)), 1) << "the position moved";
}

base::Bytes direct_map(std::uint16_t robot, std::uint32_t sequence, std::uint32_t session = kSecondSession) {
  base::Bytes out;
  encode({.robot = robot, .sequence = sequence, .session = session}, TeamMap{.states_claim = true}, out);
  return out;
}

/// Maps may overtake each other. They have no position: their sender's last state is needed.
TEST_F(DirectV2vTest, MapsAreAcceptedAfterAState) {
  one = make({}, 10.0);
  const auto take_map = [&](const base::Bytes& bytes) {
    second.queue({kLoopback, one->port()}, bytes);
    second.flush();
    int maps = 0;
    one->receive(now, [&](std::span<const std::uint8_t>) { ++maps; });
    return maps;
  };
  EXPECT_EQ(take_map(direct_map(2, 0)), 0) << "no state yet";
  EXPECT_EQ(feed(direct_state(2, 0)), 1);
  EXPECT_EQ(take_map(direct_map(2, 0)), 1);
  EXPECT_EQ(take_map(direct_map(2, 0)), 0) << "through the group, too";
  EXPECT_EQ(one->counts().duplicates, 1u);
  EXPECT_EQ(take_map(direct_map(2, 5)), 1);
  EXPECT_EQ(take_map(direct_map(2, 4)), 1) << "overtaken: pieces have numbers";
  EXPECT_EQ(count(PacketStatus::stale), 0u);
  EXPECT_EQ(take_map(direct_map(2, 6, 0x3333)), 0) << "another session";
  EXPECT_EQ(feed(direct_state(2, 1, 10.001)), 0) << "out of range";
  now = 2 * kDirectSecond - 1;
  EXPECT_EQ(take_map(direct_map(2, 7)), 1);
  now = 2 * kDirectSecond;
  EXPECT_EQ(take_map(direct_map(2, 8)), 0) << "two seconds without a state";
  EXPECT_EQ(one->counts().far, 4u);
  EXPECT_EQ(feed(direct_state(2, 2)), 1) << "maps do not count as states";
}

TEST_F(DirectV2vTest, MapsAreSigned) {
  one = make({{PeerKind::group, 0, std::nullopt, kGroupKey}});
  PacketSigner robot(kGroupKey, 1000);
  EXPECT_EQ(feed(signed_with(robot, direct_state(2, 0))), 1);
  EXPECT_EQ(feed(direct_map(2, 0)), 0);
  EXPECT_EQ(count(PacketStatus::not_signed), 1u);
  feed(signed_with(robot, direct_map(2, 0)));
  EXPECT_EQ(count(PacketStatus::accepted), 2u);
}

TEST_F(DirectV2vTest, WithoutAPositionStatesOfAnyDistanceAreAccepted) {
  DirectV2v lost({.bind = {kLoopback, 0}, .radio = 1.0, .robot = 1, .others = {2}});
  second.queue({kLoopback, lost.port()}, direct_state(2, 0, 1e6));
  second.flush();
  int states = 0;
  lost.receive(0, [&](std::span<const std::uint8_t>) { ++states; });
  EXPECT_EQ(states, 1);
}

TEST_F(DirectV2vTest, RobotsWithAKeyMustSign) {
  one = make({{PeerKind::robot, 2, std::nullopt, kSecondKey}});
  PacketSigner robot(kSecondKey, 1000), forger(kThirdKey, 5'000'000);
  EXPECT_EQ(feed(direct_state(2, 0)), 0);
  EXPECT_EQ(count(PacketStatus::not_signed), 1u);
  EXPECT_EQ(feed(signed_with(forger, direct_state(2, 0))), 0);
  EXPECT_EQ(count(PacketStatus::wrong_signature), 1u);
  EXPECT_FALSE(one->is_active(2, now));
  const base::Bytes genuine = signed_with(robot, direct_state(2, 0));
  base::Bytes changed = genuine;
  changed[kHeaderBytes] ^= 1;
  EXPECT_EQ(feed(changed), 0) << "one bit of the position was flipped";
  EXPECT_EQ(count(PacketStatus::wrong_signature), 2u);
  EXPECT_EQ(feed(genuine), 1);
  EXPECT_EQ(feed(direct_state(3, 0)), 1) << "robot 3 has no key";
  now = 3 * kDirectSecond;  // the binding ended, the counter is still known
  EXPECT_EQ(feed(genuine), 0);
  EXPECT_EQ(count(PacketStatus::replayed), 1u);
  EXPECT_FALSE(one->is_active(2, now));
  const std::string text = log.read_all();
  EXPECT_NE(text.find("of direct V2V of robot 2 from 127.0.0.1:"), std::string::npos) << text;
  EXPECT_NE(text.find("signed with another key"), std::string::npos) << text;
  EXPECT_EQ(text.find("sent before"), std::string::npos) << "a copy is normal: " << text;
}

/// With a key of the group, keys of robots are not used. Counters are kept per robot.
TEST_F(DirectV2vTest, TheGroupsKeyReplacesThoseOfRobots) {
  one = make({{PeerKind::robot, 2, std::nullopt, kSecondKey}, {PeerKind::group, 0, std::nullopt, kGroupKey}});
  PacketSigner own(kSecondKey), group(kGroupKey, 2000), other(kGroupKey, 1000);
  EXPECT_EQ(feed(signed_with(own, direct_state(2, 0))), 0);
  EXPECT_EQ(count(PacketStatus::wrong_signature), 1u);
  EXPECT_EQ(feed(signed_with(group, direct_state(2, 0))), 1);
  EXPECT_EQ(feed(signed_with(other, direct_state(3, 0))), 1) << "its counter is 1000 behind that of robot 2";
}

/// The first copy of a signed packet may come from another address: it must not bind the id to that address.
TEST_F(DirectV2vTest, ACopyOfASignedPacketDoesNotBindItsRobot) {
  one = make({{PeerKind::group, 0, std::nullopt, kGroupKey}});
  PacketSigner robot(kGroupKey, 1000);
  EXPECT_EQ(feed(signed_with(robot, direct_state(2, 0)), elsewhere), 1);
  EXPECT_EQ(feed(signed_with(robot, direct_state(2, 1))), 1);
}

TEST_F(DirectV2vTest, TheFirstSenderBindsARobotWithoutAKey) {
  EXPECT_EQ(feed(direct_state(2, 0)), 1);
  EXPECT_EQ(feed(direct_state(2, 1), elsewhere), 0) << "another address";
  EXPECT_EQ(feed(direct_state(2, 7, 1.0, 0x3333)), 0) << "another session: restarted";
  EXPECT_EQ(count(PacketStatus::wrong_source), 2u);
  now = 2 * kDirectSecond;
  EXPECT_EQ(feed(direct_state(2, 0, 1.0, 0x3333), elsewhere), 1) << "after two seconds of silence";
}

/// Without a signature, half a second of silence and the same machine.
TEST_F(DirectV2vTest, ARestartedSenderIsAcceptedAfterHalfASecond) {
  EXPECT_EQ(feed(direct_state(2, 900)), 1);
  now = DirectV2v::kRestart - 1;
  EXPECT_EQ(feed(direct_state(2, 0, 1.0, 0x3333), elsewhere), 0);
  now = DirectV2v::kRestart;
  EXPECT_EQ(feed(direct_state(2, 0, 1.0, 0x3333), elsewhere), 1);
  EXPECT_EQ(feed(direct_state(2, 901)), 0) << "the process that it replaced";
  EXPECT_FALSE(one->admit({.robot = 2, .sequence = 950, .session = 0x1234}, now)) << "relayed from before";
  EXPECT_EQ(feed(direct_state(2, 1, 1.0, 0x3333), elsewhere), 1);
  now += 2 * kDirectSecond;
  EXPECT_TRUE(one->admit({.robot = 2, .sequence = 2, .session = 0x1234}, now)) << "relayed";
}

/// With one, at once; and the other process with this id and key does not return.
TEST_F(DirectV2vTest, ARestartedSenderWithAKeyIsAcceptedAtOnce) {
  one = make({{PeerKind::group, 0, std::nullopt, kGroupKey}});
  PacketSigner before(kGroupKey, 1000), after(kGroupKey, 2000), forger(kSecondKey, 3000);
  EXPECT_EQ(feed(signed_with(before, direct_state(2, 900))), 1);
  EXPECT_EQ(feed(signed_with(forger, direct_state(2, 0, 1.0, 0x4444))), 0);
  EXPECT_EQ(feed(signed_with(after, direct_state(2, 0, 1.0, 0x3333))), 1);
  PacketSigner again(kGroupKey, 4000);
  EXPECT_EQ(feed(signed_with(again, direct_state(2, 901))), 0);
  EXPECT_EQ(count(PacketStatus::wrong_source), 1u);
}

TEST_F(DirectV2vTest, AddressesOfTheTableAreChecked) {
  one = make({{PeerKind::robot, 2, kLoopback + 1, std::nullopt}, {PeerKind::robot, 3, kLoopback, std::nullopt}});
  EXPECT_EQ(feed(direct_state(2, 0)), 0);
  EXPECT_EQ(count(PacketStatus::wrong_source), 1u);
  EXPECT_EQ(feed(direct_state(3, 0)), 1);
}

TEST_F(DirectV2vTest, AStateCountsOnceHoweverItArrives) {
  EXPECT_EQ(feed(direct_state(2, 5)), 1);
  EXPECT_EQ(feed(direct_state(2, 5)), 0) << "through the group, too";
  EXPECT_EQ(count(PacketStatus::stale), 0u) << "a duplicate is normal";
  EXPECT_FALSE(one->admit({.robot = 2, .sequence = 5}, now)) << "relayed, too";
  EXPECT_FALSE(one->admit({.robot = 2, .sequence = 4}, now)) << "relayed late";
  EXPECT_EQ(one->counts().duplicates, 3u);
  EXPECT_TRUE(one->admit({.robot = 2, .sequence = 6}, now)) << "the direct packet was lost";
  EXPECT_EQ(feed(direct_state(2, 6)), 0) << "the direct packet was late";
  EXPECT_EQ(one->counts().duplicates, 4u);
  EXPECT_FALSE(one->admit({.robot = 4, .sequence = 0}, now)) << "not a robot of the world";
}

/// Boundary: the last datagram that is checked in a tenth of a second, the next one, and the next period.
TEST_F(DirectV2vTest, AFloodIsDroppedUnread) {
  now = kDirectSecond;
  const base::Bytes noise(10, 0xAA);
  for (std::size_t sent = 1; sent < DirectV2v::kMaxPerPeriod; ++sent) ASSERT_EQ(feed(noise), 0);
  EXPECT_EQ(feed(direct_state(2, 0)), 1);
  EXPECT_EQ(feed(direct_state(2, 1)), 0);
  EXPECT_EQ(one->counts().over_rate, 1u);
  EXPECT_NE(log.read_all().find("dropped unread: more than 10000 arrived within 0.1 s"), std::string::npos);
  now += kDirectSecond / 10;
  EXPECT_EQ(feed(direct_state(2, 2)), 1);
}

TEST_F(DirectV2vTest, SendsToEveryAddressSignedOnce) {
  const Socket three = open_udp({kLoopback, 0});
  DirectV2v sender({.bind = {kLoopback, 0},
                    .peers = {{kLoopback, one->port()}, {kLoopback, bound_endpoint(three).port}},
                    .robot = 2,
                    .others = {1, 3},
                    .table = {{PeerKind::robot, 2, std::nullopt, kSecondKey}}});
  one = nullptr;  // frees its port for a receiver with the key
  DirectV2v receiver({.bind = sender.options().peers[0],
                      .robot = 1,
                      .others = {2, 3},
                      .table = {{PeerKind::robot, 2, std::nullopt, kSecondKey}}});
  for (std::uint32_t sequence = 0; sequence < 3; ++sequence) sender.send(direct_state(2, sequence));
  receiver.receive(0, [](std::span<const std::uint8_t>) {});
  EXPECT_EQ(receiver.counts().packets[PacketStatus::accepted], 3u);
  ReceiveBatch batch(8);
  EXPECT_EQ(batch.fill(three), 3u);
  EXPECT_EQ(sender.counts().sent.sent, 6u);
}

/// Two robots of one machine at one port of the group. Each also receives its own packets.
TEST_F(DirectV2vTest, AGroupReachesAllRobotsOfAMachine) {
  const std::uint16_t port = bound_endpoint(open_udp({kLoopback, 0})).port;
  const auto robot = [&](std::uint32_t id) {
    return DirectV2vOptions{.bind = {kLoopback, 0},
                            .group = Endpoint{0xEFFF0001u, port},
                            .interface_address = kLoopback,
                            .robot = id,
                            .others = {3 - id},
                            .table = {{PeerKind::group, 0, std::nullopt, kGroupKey}}};
  };
  std::unique_ptr<DirectV2v> two;
  try {
    one = std::make_unique<DirectV2v>(robot(1)), two = std::make_unique<DirectV2v>(robot(2));
  } catch (const base::InputError& error) {
    GTEST_SKIP() << "no multicast on loopback: " << error.what();
  }
  two->send(direct_state(2, 0));
  if (two->counts().sent.failed > 0) GTEST_SKIP() << "no multicast on loopback: " << two->counts().sent.first_failure;
  one->receive(0, [](std::span<const std::uint8_t>) {});
  two->receive(0, [](std::span<const std::uint8_t>) {});
  if (two->counts().own == 0) GTEST_SKIP() << "this machine does not return multicast to its own sockets";
  EXPECT_EQ(count(PacketStatus::accepted), 1u);
  EXPECT_EQ(two->counts().packets.total(), 0u);
}

TEST(DirectV2v, RefusesAddressesThatCannotWork) {
  const auto refusal = [](const DirectV2vOptions& options) { return refusal_of([&] { DirectV2v direct(options); }); };
  EXPECT_NE(refusal({.bind = {kLoopback, 0}, .peers = {{0xEFFF0001u, 9400}}}).find("--v2v-group"), std::string::npos);
  EXPECT_NE(refusal({.bind = {kLoopback, 0}, .group = Endpoint{kLoopback, 9400}}).find("is not a multicast group"),
            std::string::npos);
  EXPECT_NE(refusal({.bind = {kLoopback, 9400}, .group = Endpoint{0xEFFF0001u, 9400}}).find("different ports"),
            std::string::npos);
  const std::vector<Endpoint> many(DirectV2v::kMaxReceivers + 1, {kLoopback, 9400});
  EXPECT_NE(refusal({.bind = {kLoopback, 0}, .peers = many}).find("at most 1024"), std::string::npos);
}

/// Boundaries of 224.0.0.0/4.
TEST(DirectV2v, GroupsHaveMulticastAddresses) {
  EXPECT_FALSE(is_multicast(0xDFFFFFFFu));
  EXPECT_TRUE(is_multicast(0xE0000000u));
  EXPECT_TRUE(is_multicast(0xEFFFFFFFu));
  EXPECT_FALSE(is_multicast(0xF0000000u));
}

}  // namespace
}  // namespace sf::netio
