// Peers of an inbox: configured addresses and keys.

#include "netio/peers.h"

#include <gtest/gtest.h>

#include "netio/inbox.h"
#include "netio/outbox.h"
#include "netio/v2v_socket.h"
#include "tests/netio/examples.h"
#include "tests/units.h"

namespace sf::netio {
namespace {

constexpr Endpoint kPeerSource{kLoopback, 5001};
constexpr Endpoint kElsewhere{kLoopback + 1, 5001};
constexpr SigningKey kRobotKey{1}, kTagKey{2}, kStartKey{3};

/// Robots 7 (with a key), 3 (without one) and 5 (with an address), and a tag and START with keys.
InboxOptions peer_options() {
  return {.bind = {kLoopback, 0},
          .robots = {7, 3, 5},
          .tags = {12},
          .peers = {{PeerKind::robot, 7, std::nullopt, kRobotKey},
                    {PeerKind::start, 0, std::nullopt, kStartKey},
                    {PeerKind::tag, 12, std::nullopt, kTagKey},
                    {PeerKind::robot, 5, kLoopback, std::nullopt}}};
}

base::Bytes peer_v2v(std::uint16_t robot, std::uint32_t sequence) {
  base::Bytes out;
  encode({.robot = robot, .sequence = sequence}, V2v{}, out);
  return out;
}

struct PeersTest : testing::Test {
  Inbox inbox{peer_options()};
  PacketSigner robot{kRobotKey, 1000};
  Packet packet;
  /// Adds the token of its source and a signature of `signer`.
  base::Bytes ready(base::Bytes bytes, PacketSigner* signer, const Endpoint& who = kPeerSource) {
    write_session_token(bytes, {77, inbox.token(who)});
    if (signer != nullptr) signer->sign(bytes);
    return bytes;
  }
  PacketStatus accept(const base::Bytes& bytes, const Endpoint& who = kPeerSource) {
    return inbox.accept(bytes, who, 0, packet);
  }
  PacketStatus feed(const base::Bytes& bytes, PacketSigner* signer, const Endpoint& who = kPeerSource) {
    return accept(ready(bytes, signer, who), who);
  }
};

TEST_F(PeersTest, RobotWithAKeyMustSign) {
  PacketSigner forger(kTagKey, 1'000'000);
  EXPECT_EQ(feed(peer_v2v(7, 0), nullptr), PacketStatus::not_signed);
  EXPECT_EQ(feed(peer_v2v(7, 0), &forger), PacketStatus::wrong_signature);
  EXPECT_FALSE(inbox.is_active(7, 0));
  const base::Bytes first = ready(peer_v2v(7, 0), &robot), second = ready(peer_v2v(7, 1), &robot);
  EXPECT_EQ(accept(second), PacketStatus::accepted);
  EXPECT_EQ(accept(second), PacketStatus::replayed);
  EXPECT_EQ(accept(first), PacketStatus::stale) << "overtaken: signed and new, but an older state";
  EXPECT_EQ(accept(first), PacketStatus::replayed);
  EXPECT_EQ(feed(subscribe_example(), &robot), PacketStatus::accepted);
  EXPECT_EQ(feed(leave_example(), nullptr), PacketStatus::not_signed) << "no other sender may end its participation";
  EXPECT_TRUE(inbox.is_active(7, 0));
  EXPECT_EQ(feed(leave_example(), &robot), PacketStatus::accepted);
  EXPECT_EQ(inbox.counts()[PacketStatus::not_signed], 2u);
  EXPECT_EQ(inbox.counts()[PacketStatus::wrong_signature], 1u);
  EXPECT_EQ(inbox.counts()[PacketStatus::replayed], 2u);
}

/// An attacker on the path copies a packet and sends it first, from another address.
TEST_F(PeersTest, CopyFromAnotherAddressDoesNotBlockThePacket) {
  const base::Bytes genuine = ready(peer_v2v(7, 0), &robot);
  EXPECT_EQ(accept(genuine, kElsewhere), PacketStatus::unproven) << "the token is another address'";
  EXPECT_EQ(accept(genuine, kElsewhere), PacketStatus::unproven) << "its counter did not count";
  EXPECT_EQ(accept(genuine), PacketStatus::accepted);
}

/// Boundary: the last signature of a stranger that is checked in 0.1 s, and the first that is not.
TEST_F(PeersTest, LimitsSignatureChecksForStrangers) {
  base::Bytes request = peer_v2v(7, 0);
  write_session_token(request, {77, 0});
  base::Bytes forged = request;
  PacketSigner forger(kTagKey, 1);
  forger.sign(forged);
  robot.sign(request);
  for (std::size_t i = 1; i < Inbox::kMaxDoubtfulSignatures; ++i)
    ASSERT_EQ(accept(forged), PacketStatus::wrong_signature);
  EXPECT_EQ(accept(request), PacketStatus::unproven) << "the last that is checked: a CHALLENGE is its answer";
  EXPECT_EQ(accept(request), PacketStatus::wrong_signature) << "not checked";
  EXPECT_EQ(feed(peer_v2v(7, 1), &robot), PacketStatus::accepted) << "robots at proven addresses are not concerned";
  EXPECT_EQ(inbox.accept(request, kPeerSource, kSecond, packet), PacketStatus::unproven) << "later";
}

TEST_F(PeersTest, RobotWithoutAKeyNeedsNoSignature) {
  EXPECT_EQ(feed(peer_v2v(3, 0), nullptr), PacketStatus::accepted);
  EXPECT_EQ(feed(peer_v2v(3, 1), &robot), PacketStatus::accepted) << "its trailer is dropped";
  EXPECT_EQ(inbox.signer(3), nullptr);
  EXPECT_EQ(inbox.signer(99), nullptr);
}

TEST_F(PeersTest, TagWithAKeyMustSign) {
  PacketSigner camera(kTagKey, 0);
  EXPECT_EQ(feed(tag_example(), nullptr), PacketStatus::not_signed);
  EXPECT_EQ(feed(tag_example(), &robot), PacketStatus::wrong_signature);
  const base::Bytes tag = ready(tag_example(), &camera);
  EXPECT_EQ(accept(tag), PacketStatus::accepted);
  EXPECT_EQ(accept(tag), PacketStatus::replayed);
}

/// START to one robot and to all have the same sender.
TEST_F(PeersTest, OnlyTheSenderOfStartSignsIt) {
  PacketSigner user(kStartKey, 1);
  const base::Bytes to_one = patched<std::uint16_t>(start_example(), 6, 7);
  EXPECT_EQ(feed(start_example(), nullptr), PacketStatus::not_signed);
  EXPECT_EQ(feed(to_one, &robot), PacketStatus::wrong_signature) << "a robot's key is not valid for START";
  EXPECT_EQ(feed(to_one, &user), PacketStatus::accepted);
  const base::Bytes to_all = ready(start_example(), &user);
  EXPECT_EQ(accept(to_all), PacketStatus::accepted);
  EXPECT_EQ(accept(to_all), PacketStatus::replayed);
}

/// Boundary: another port of the same address, and an address one higher.
TEST_F(PeersTest, AcceptsOnlyTheConfiguredAddress) {
  EXPECT_EQ(feed(peer_v2v(5, 0), nullptr, kElsewhere), PacketStatus::wrong_source);
  EXPECT_FALSE(inbox.is_active(5, 0));
  EXPECT_EQ(feed(peer_v2v(5, 0), nullptr, {kLoopback, 5999}), PacketStatus::accepted);
  EXPECT_EQ(feed(peer_v2v(5, 1), nullptr, kPeerSource), PacketStatus::wrong_source)
      << "bound by its first sender as without";
}

/// An unproven request is signed even without the token, and so is the answer, which is no larger.
TEST_F(PeersTest, ChallengesAreSignedAndNoLargerThanTheRequest) {
  base::Bytes request = subscribe_example(), answer;
  write_session_token(request, {77, 0});
  EXPECT_EQ(accept(request), PacketStatus::not_signed) << "no answer to strangers";
  robot.sign(request);
  ASSERT_EQ(accept(request), PacketStatus::unproven);
  ASSERT_TRUE(inbox.challenge(packet, kPeerSource, 0, answer));
  EXPECT_EQ(answer.size(), request.size());
  EXPECT_EQ(SignatureChecker(kRobotKey).check(answer), PacketStatus::accepted);
  ASSERT_EQ(decode(answer, packet), PacketStatus::accepted);
  EXPECT_EQ(std::get<Challenge>(packet.body).token, inbox.token(kPeerSource));
}

/// A REFUSAL is unsigned and no larger than the smallest packet that it answers. LEAVE, TAG and START get none.
TEST_F(PeersTest, RefusalsAreNoLargerAndLimited) {
  base::Bytes request = subscribe_example(), answer;
  ASSERT_EQ(accept(request), PacketStatus::not_signed);
  ASSERT_TRUE(inbox.refuse(packet, PacketStatus::not_signed, 0, answer));
  EXPECT_LE(answer.size(), request.size());
  Packet refusal;
  ASSERT_EQ(decode(answer, refusal), PacketStatus::accepted);
  EXPECT_EQ(std::get<Refusal>(refusal.body).reason, PacketStatus::not_signed);
  EXPECT_EQ(refusal.header.token, packet.header.session);
  ASSERT_TRUE(inbox.refuse(packet, PacketStatus::wrong_source, 100'000'000, answer));
  ASSERT_EQ(decode(answer, refusal), PacketStatus::accepted);
  EXPECT_EQ(std::get<Refusal>(refusal.body).reason, PacketStatus::wrong_source);
  ++answer[kHeaderBytes];
  EXPECT_EQ(decode(answer, refusal), PacketStatus::out_of_range) << "reasons of later versions are unknown";
  std::size_t more = 0;
  while (inbox.refuse(packet, PacketStatus::not_signed, 100'000'001, answer)) ++more;
  EXPECT_EQ(more + 1, Inbox::kMaxRefusals) << "in 0.1 s";
  EXPECT_TRUE(inbox.refuse(packet, PacketStatus::not_signed, 200'000'000, answer));
  for (const base::Bytes& bytes : {leave_example(), tag_example(), start_example()}) {
    ASSERT_EQ(decode(bytes, packet), PacketStatus::accepted);
    EXPECT_FALSE(inbox.refuse(packet, PacketStatus::not_signed, kSecond, answer));
  }
}

/// Counters that are a second or more behind mean a clock that was set back; smaller lags are copies. Boundary: 1 s.
TEST_F(PeersTest, ReportsTheLagOfACounter) {
  for (const std::uint64_t lag : {64u, 999'999u, 1'000'000u}) {
    PacketSigner now(kRobotKey, 1u << 30), then(kRobotKey, (1u << 30) - lag);
    Inbox fresh{peer_options()};
    base::Bytes bytes = peer_v2v(7, 0);
    write_session_token(bytes, {77, fresh.token(kPeerSource)});
    base::Bytes late = bytes;
    now.sign(bytes), then.sign(late);
    ASSERT_EQ(fresh.accept(bytes, kPeerSource, 0, packet), PacketStatus::accepted);
    ASSERT_EQ(fresh.accept(late, kPeerSource, 0, packet), PacketStatus::replayed);
    EXPECT_EQ(fresh.lag({PeerKind::robot, 7}), lag);
  }
}

TEST_F(PeersTest, UnknownIdsTakePrecedence) {
  EXPECT_EQ(feed(peer_v2v(8, 0), nullptr), PacketStatus::unknown_robot);
  EXPECT_EQ(feed(reading_example(), nullptr), PacketStatus::wrong_direction);
}

/// The window keeps late states for the filter.
TEST(Peers, OvertakenStatesAreLateNotReplayed) {
  InboxOptions chosen = peer_options();
  chosen.take_late = true;
  Inbox inbox(chosen);
  Packet packet;
  const auto feed = [&](std::uint32_t sequence) {
    base::Bytes bytes = peer_v2v(7, sequence);
    write_session_token(bytes, {77, inbox.token(kPeerSource)});
    sign(bytes, kRobotKey, 1000 + sequence);
    return inbox.accept(bytes, kPeerSource, 0, packet);
  };
  EXPECT_EQ(feed(100), PacketStatus::accepted);
  EXPECT_EQ(feed(37), PacketStatus::accepted) << "63 behind";
  EXPECT_TRUE(packet.late);
  EXPECT_EQ(feed(36), PacketStatus::replayed) << "64 behind";
}

constexpr std::uint32_t kFarm = 11, kOwn = 22;  ///< sessions

/// A robot's socket, and a farm that the test simulates.
struct SignedSocketTest : testing::Test {
  Outbox farm{OutboxOptions{.bind = {kLoopback, 0}}};
  V2vSocket socket{{.farm = farm.endpoint(), .robot = 7, .others = {3}, .session = kOwn, .key = kRobotKey}};
  PacketSigner signer{kRobotKey, 1000};
  Packet packet;
  void SetUp() override {
    base::Bytes challenge;
    encode({.robot = 7}, Challenge{3}, challenge);
    ASSERT_EQ(receive(challenge, {kFarm, kOwn}, &signer), 1u);
  }
  /// Receives an encoded DRIVE, unchanged.
  PacketStatus receive_drive(const base::Bytes& bytes, Outbox& from, std::int64_t now = 0) {
    const PacketCounts before = socket.counts();
    from.queue({kLoopback, bound_endpoint(socket.socket()).port}, bytes);
    from.flush();
    wait_readable(socket.socket(), socket.socket(), 1000);
    socket.receive([&](std::span<const std::uint8_t> one) { socket.accept(one, now, packet); });
    for (std::size_t i = 0; i < kPacketStatuses; ++i)
      if (socket.counts()[static_cast<PacketStatus>(i)] != before[static_cast<PacketStatus>(i)])
        return static_cast<PacketStatus>(i);
    return PacketStatus::unproven;
  }
  base::Bytes drive(std::uint32_t sequence, const SessionToken& token, PacketSigner* by, std::uint16_t robot = 7) {
    base::Bytes bytes;
    encode({.robot = robot, .sequence = sequence}, Drive{{0.25, 0.0, 0.0}}, bytes);
    write_session_token(bytes, token);
    if (by != nullptr) by->sign(bytes);
    return bytes;
  }
  /// @return number of states and other packets that pass
  std::size_t receive(const base::Bytes& bytes, const SessionToken& session_token, PacketSigner* by) {
    farm.queue({kLoopback, bound_endpoint(socket.socket()).port}, bytes, session_token, by);
    farm.flush();
    wait_readable(socket.socket(), socket.socket(), 1000);
    std::size_t accepted = 0;
    socket.receive([&](std::span<const std::uint8_t> one) {
      accepted += socket.accept(one, 0, packet) == PacketStatus::accepted ? 1 : 0;
    });
    return accepted;
  }
};

/// A REFUSAL with this robot's session is accepted without a signature, but only for a message. With another session it
/// is rejected.
TEST_F(SignedSocketTest, RefusalChangesNothing) {
  base::Bytes refusal;
  encode({.robot = 7, .time = 9}, Refusal{PacketStatus::wrong_signature}, refusal);
  EXPECT_EQ(receive(refusal, {kFarm, kOwn + 1}, nullptr), 0u);
  EXPECT_EQ(socket.trouble().count, 0u) << "of another session";
  EXPECT_EQ(receive(refusal, {kFarm + 1, kOwn}, nullptr), 0u);
  EXPECT_TRUE(socket.trouble().of_farm);
  EXPECT_EQ(socket.trouble().reason, PacketStatus::wrong_signature);
  EXPECT_EQ(socket.trouble().farm_time, 9);
  EXPECT_EQ(socket.farm_session_token().session, kFarm) << "as before";
}

/// A robot follows DRIVE only from its farm, signed, in order, once.
TEST_F(SignedSocketTest, AcceptsDriveOnlyFromItsFarm) {
  constexpr SessionToken kBoth{kFarm, kOwn};
  const base::Bytes first = drive(5, kBoth, &signer);
  EXPECT_EQ(receive_drive(first, farm), PacketStatus::accepted);
  EXPECT_EQ(std::get<Drive>(packet.body).twist.forward, 0.25);
  EXPECT_EQ(receive_drive(first, farm), PacketStatus::replayed);
  EXPECT_EQ(receive_drive(first, farm, 60'000'000'000), PacketStatus::replayed) << "also a minute later";
  EXPECT_EQ(receive_drive(drive(4, kBoth, &signer), farm), PacketStatus::stale) << "overtaken";
  EXPECT_EQ(receive_drive(drive(6, kBoth, nullptr), farm), PacketStatus::not_signed);
  PacketSigner forger(SigningKey{99}, 5000);
  EXPECT_EQ(receive_drive(drive(7, kBoth, &forger), farm), PacketStatus::wrong_signature);
  Outbox stranger{OutboxOptions{.bind = {kLoopback, 0}}};
  EXPECT_EQ(receive_drive(drive(8, kBoth, &signer), stranger), PacketStatus::wrong_source);
  EXPECT_EQ(receive_drive(drive(9, {kFarm, kOwn + 1}, &signer), farm), PacketStatus::wrong_source) << "session";
  EXPECT_EQ(receive_drive(drive(10, {kFarm + 1, kOwn}, &signer), farm), PacketStatus::wrong_source) << "other farm";
  EXPECT_EQ(receive_drive(drive(11, kBoth, &signer, 3), farm), PacketStatus::unknown_robot);
  EXPECT_EQ(receive_drive(drive(12, kBoth, &signer), farm), PacketStatus::accepted) << "nothing is blocked";
}

/// No other machine can reach a robot whose farm is on its machine. Boundary: any address of 127.0.0.0/8.
TEST(V2vSocket, BindsToLoopbackForALocalFarm) {
  const auto own_address = [](std::uint32_t farm) {
    return bound_endpoint(V2vSocket({.farm = {farm, 9000}, .robot = 7}).socket()).address;
  };
  EXPECT_EQ(own_address(kLoopback), kLoopback);
  EXPECT_EQ(own_address(0x7FFFFFFE), kLoopback);
  EXPECT_EQ(own_address(0x80000001), 0u);
  EXPECT_EQ(own_address(0xC0A80107), 0u);
}

base::Bytes neighbours() {
  base::Bytes state, out;
  encode({.robot = 3, .session = kFarm, .token = kOwn}, V2v{}, state);
  encode({.robot = 7}, Neighbours{state}, out);
  return out;
}

TEST_F(SignedSocketTest, AcceptsEachSignedPacketOnce) {
  EXPECT_EQ(receive(neighbours(), {kFarm, kOwn}, nullptr), 0u);
  EXPECT_EQ(socket.counts()[PacketStatus::not_signed], 1u);
  PacketSigner forger(kTagKey, 1'000'000);
  EXPECT_EQ(receive(start_example(), {kFarm, kOwn}, &forger), 0u);
  EXPECT_EQ(socket.counts()[PacketStatus::wrong_signature], 1u);
  EXPECT_EQ(receive(neighbours(), {kFarm, kOwn}, &signer), 1u);
  EXPECT_EQ(receive(start_example(), {kFarm, kOwn}, &signer), 1u);
  PacketSigner again(kRobotKey, 1000);
  EXPECT_EQ(receive(start_example(), {kFarm, kOwn}, &again), 0u);
  EXPECT_EQ(socket.counts()[PacketStatus::replayed], 1u);
}

/// Boundary: the robot's clock is ahead of the farm's, and so are its counters.
TEST_F(SignedSocketTest, OwnPacketsSentBackDoNotAdvanceTheWindow) {
  PacketSigner own(kRobotKey, 1'000'000);
  EXPECT_EQ(receive(v2v_example(), {kOwn, 3}, &own), 0u);
  EXPECT_EQ(socket.counts()[PacketStatus::wrong_source], 1u);
  EXPECT_EQ(receive(neighbours(), {kFarm, kOwn}, &signer), 1u);
}

TEST_F(SignedSocketTest, SendsSignedPackets) {
  const Socket receiver = open_udp({kLoopback, 0});
  V2vSocket client({.farm = {kLoopback, bound_endpoint(receiver).port}, .robot = 7, .key = kRobotKey});
  SignatureChecker checker(kRobotKey);
  ReceiveBatch batch(1);
  for (int i = 0; i < 2; ++i) {
    client.send(v2v_example());
    while (batch.fill(receiver) == 0) wait_readable(receiver, receiver, 1000);
    EXPECT_EQ(checker.check(batch.bytes(0)), PacketStatus::accepted) << "each with its own counter";
  }
}

}  // namespace
}  // namespace sf::netio
