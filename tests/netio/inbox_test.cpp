#include "netio/inbox.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "base/error.h"
#include "netio/outbox.h"
#include "tests/netio/examples.h"
#include "tests/refusal.h"
#include "tests/units.h"

namespace sf::netio {
namespace {

constexpr Endpoint kSender{kLoopback, 5001};
constexpr Endpoint kOtherSender{kLoopback, 5002};
constexpr std::uint32_t kLaser = 1;
constexpr std::uint32_t kSession = 77;  ///< of all robots here

constexpr std::uint16_t kKeyed = 5;  ///< id of the robot with a key
constexpr SigningKey kKey{1};

InboxOptions options() {
  return {.bind = {kLoopback, 0},
          .robots = {7, 3, kKeyed},
          .tags = {12},
          .peers = {{PeerKind::robot, kKeyed, std::nullopt, kKey}}};
}

base::Bytes v2v(std::uint16_t robot, std::uint32_t sequence) {
  base::Bytes out;
  encode({.robot = robot, .sequence = sequence}, V2v{}, out);
  return out;
}

base::Bytes subscribe(std::uint32_t sequence, std::uint32_t types) {
  base::Bytes out;
  encode({.robot = 7, .sequence = sequence}, Subscribe{types}, out);
  return out;
}

base::Bytes leave_of_keyed() { return patched(leave_example(), 6, kKeyed); }

base::Bytes signed_leave() {
  base::Bytes bytes = leave_of_keyed();
  sign(bytes, kKey, 1);
  return bytes;
}

struct InboxTest : testing::Test {
  Inbox inbox{options()};
  Packet packet;
  /// Returns a signed LEAVE with the token of `who`.
  base::Bytes proven_leave(const Endpoint& who) {
    base::Bytes bytes = leave_of_keyed();
    write_session_token(bytes, {kSession, inbox.token(who)});
    sign(bytes, kKey, 1);
    return bytes;
  }
  /// Receives a packet with the token of its source.
  PacketStatus send(base::Bytes bytes, std::int64_t now = 0, const Endpoint& who = kSender) {
    if (bytes.size() >= kHeaderBytes) write_session_token(bytes, {kSession, inbox.token(who)});
    return inbox.accept(bytes, who, now, packet);
  }
};

// The rules are those of V2V, of whose session they must be.
TEST_F(InboxTest, OwnReadingsBelongToAnActiveRobot) {
  const auto own = [](std::uint16_t robot, std::uint32_t sequence) {
    return patched(patched(own_readings_example(), 6, robot), 12, sequence);
  };
  EXPECT_EQ(send(own(9, 0)), PacketStatus::unknown_robot);
  EXPECT_EQ(inbox.accept(own(7, 0), kSender, 0, packet), PacketStatus::unproven);
  EXPECT_EQ(send(own(7, 0)), PacketStatus::stale) << "no V2V yet";
  EXPECT_EQ(send(v2v(7, 5), 1), PacketStatus::accepted);
  EXPECT_EQ(send(own(7, 3), 2), PacketStatus::accepted);
  EXPECT_EQ(std::get<OwnReadings>(packet.body).total, 3u);
  EXPECT_EQ(send(own(7, 3), 3), PacketStatus::stale) << "again";
  EXPECT_EQ(send(own(7, 4), 4, kOtherSender), PacketStatus::wrong_source);
  EXPECT_EQ(send(v2v(7, 6), 5), PacketStatus::accepted) << "they are counted separately";
  base::Bytes other = own(7, 4);
  write_session_token(other, {kSession + 1, inbox.token(kSender)});
  EXPECT_EQ(inbox.accept(other, kSender, 6, packet), PacketStatus::stale) << "of another session";
  EXPECT_EQ(send(own(7, 4), 1'999'000'000), PacketStatus::accepted);
  EXPECT_TRUE(inbox.is_active(7, 3'500'000'000));
  EXPECT_EQ(send(own(7, 5), 4'000'000'000), PacketStatus::stale) << "the robot is silent";
  EXPECT_EQ(send(own(kKeyed, 0), 0), PacketStatus::not_signed);
}

TEST(Inbox, AcceptsOvertakenStatesOnRequest) {
  InboxOptions chosen = options();
  chosen.take_late = true;
  Inbox inbox(chosen);
  Packet packet;
  const auto send = [&](base::Bytes bytes, std::int64_t now, const Endpoint& who = kSender) {
    write_session_token(bytes, {kSession, inbox.token(who)});
    return inbox.accept(bytes, who, now, packet);
  };
  EXPECT_EQ(send(v2v(7, 5), 0), PacketStatus::accepted);
  EXPECT_FALSE(packet.late);
  EXPECT_EQ(send(v2v(7, 4), 1), PacketStatus::accepted);
  EXPECT_TRUE(packet.late);
  EXPECT_EQ(send(v2v(7, 5), 2), PacketStatus::accepted) << "a replay, which the filter refuses";
  EXPECT_TRUE(packet.late);
  EXPECT_EQ(send(v2v(7, 4), 3, kOtherSender), PacketStatus::wrong_source);
  EXPECT_EQ(send(subscribe(9, 0), 4), PacketStatus::accepted);
  EXPECT_EQ(send(subscribe(8, 0), 5), PacketStatus::stale) << "only states have their own time";
  base::Bytes leave;
  encode({.robot = 7}, Leave{}, leave);
  EXPECT_EQ(send(leave, 6), PacketStatus::accepted);
  EXPECT_EQ(send(v2v(7, 6), 7), PacketStatus::stale) << "after a LEAVE";
  // A late state does not extend the binding: two seconds after the last state in order, the id is free.
  EXPECT_EQ(send(v2v(3, 5), 10), PacketStatus::accepted);
  EXPECT_EQ(send(v2v(3, 4), kSecond), PacketStatus::accepted);
  EXPECT_FALSE(inbox.is_active(3, 2 * kSecond + 10));
}

/// Accepts packets of lockstep with the robot's session, after its SUBSCRIBE. The other packets are rejected.
TEST(Inbox, LockstepAcceptsItsOwnPacketTypes) {
  InboxOptions chosen = options();
  chosen.lockstep = true;
  Inbox inbox(chosen), plain(options());
  Packet packet;
  const auto send = [&](Inbox& to, base::Bytes bytes, std::int64_t now, std::uint32_t session = kSession,
                        const Endpoint& who = kSender) {
    write_session_token(bytes, {session, to.token(who)});
    return to.accept(bytes, who, now, packet);
  };
  for (const base::Bytes& bytes : {command_example(), step_example(), fetch_example()}) {
    EXPECT_EQ(send(plain, bytes, 0), PacketStatus::wrong_direction);
    EXPECT_EQ(send(inbox, bytes, 0), PacketStatus::stale) << "before any SUBSCRIBE";
  }
  EXPECT_EQ(send(inbox, subscribe(0, 0), 0), PacketStatus::accepted);
  for (const base::Bytes& bytes : {command_example(), step_example(), fetch_example()}) {
    EXPECT_EQ(send(inbox, bytes, 1), PacketStatus::accepted);
    EXPECT_EQ(send(inbox, bytes, 1), PacketStatus::accepted) << "repeated";
    EXPECT_EQ(send(inbox, bytes, 1, kSession + 1), PacketStatus::stale) << "of a process before";
    EXPECT_EQ(send(inbox, bytes, 1, kSession, kOtherSender), PacketStatus::wrong_source);
    EXPECT_EQ(send(inbox, patched<std::uint16_t>(bytes, 6, 9), 1), PacketStatus::unknown_robot);
  }
  for (const base::Bytes& bytes : {state_example(), values_example(), v2v(7, 9), tag_example(), start_example()})
    EXPECT_EQ(send(inbox, bytes, 2), PacketStatus::wrong_direction);
  EXPECT_EQ(send(inbox, leave_example(), 60 * kSecond), PacketStatus::accepted) << "after a long silence, too";
  EXPECT_FALSE(inbox.address(7));
  EXPECT_EQ(inbox.accept(step_example(), kSender, 0, packet), PacketStatus::unproven);
  base::Bytes challenge;
  ASSERT_TRUE(inbox.challenge(packet, kSender, 0, challenge));
  for (const base::Bytes& bytes : {command_example(), step_example(), fetch_example()})
    EXPECT_LE(challenge.size(), bytes.size()) << "no amplification";
}

TEST_F(InboxTest, ReachesAndCountsEveryReason) {
  base::Bytes long_packet = v2v_example();
  long_packet.push_back(0);
  EXPECT_EQ(send({}), PacketStatus::too_short);
  EXPECT_EQ(send(patched<std::uint8_t>(v2v_example(), 0, 'X')), PacketStatus::bad_magic);
  EXPECT_EQ(send(patched<std::uint8_t>(v2v_example(), 4, 1)), PacketStatus::unknown_version);
  EXPECT_EQ(send(patched<std::uint8_t>(v2v_example(), 5, 0)), PacketStatus::unknown_type);
  EXPECT_EQ(send(long_packet), PacketStatus::too_long);
  EXPECT_EQ(send(patched(v2v_example(), 64, std::numeric_limits<double>::quiet_NaN())), PacketStatus::not_finite);
  EXPECT_EQ(send(patched(v2v_example(), 64, 2e7)), PacketStatus::out_of_range);
  EXPECT_EQ(send(reading_example()), PacketStatus::wrong_direction);
  EXPECT_EQ(send(v2v(8, 0)), PacketStatus::unknown_robot);
  EXPECT_EQ(send(patched<std::uint16_t>(tag_example(), 6, 7)),
            PacketStatus::unknown_tag);  // robots and tags have separate ids
  EXPECT_EQ(send(v2i_example()), PacketStatus::unknown_light);
  EXPECT_EQ(send(leave_of_keyed()), PacketStatus::not_signed);
  EXPECT_EQ(send(signed_leave()), PacketStatus::wrong_signature);  // changed by its token
  EXPECT_EQ(inbox.accept(signed_leave(), kSender, 0, packet), PacketStatus::unproven);
  // The counter of the unproven packet was not recorded. It is a LEAVE of a robot that has never sent a packet.
  EXPECT_EQ(inbox.accept(proven_leave(kSender), kSender, 0, packet), PacketStatus::stale);
  EXPECT_EQ(inbox.accept(proven_leave(kSender), kSender, 0, packet), PacketStatus::replayed);
  EXPECT_EQ(send(v2v_example()), PacketStatus::accepted);
  EXPECT_EQ(send(v2v(7, 10), 0, kOtherSender), PacketStatus::wrong_source);
  for (std::size_t i = 0; i < kPacketStatuses; ++i)
    EXPECT_EQ(inbox.counts().of[i], 1u) << name(static_cast<PacketStatus>(i));
  EXPECT_EQ(inbox.counts().dropped(), kPacketStatuses - 1);
}

TEST_F(InboxTest, DroppedPacketsDoNotActivateARobot) {
  send(patched(v2v_example(), 64, 2e7));
  send(reading_example());
  EXPECT_FALSE(inbox.is_active(7, 0));
  EXPECT_FALSE(inbox.address(7));
}

TEST_F(InboxTest, StateAndSubscribeActivateForTwoSeconds) {
  send(v2v(7, 0), 0);
  EXPECT_TRUE(inbox.is_active(7, 2 * kSecond - 1));
  EXPECT_FALSE(inbox.is_active(7, 2 * kSecond));
  send(subscribe(0, 0), 3 * kSecond);
  EXPECT_TRUE(inbox.is_active(7, 5 * kSecond - 1));
  EXPECT_FALSE(inbox.is_active(7, 5 * kSecond));
  EXPECT_FALSE(inbox.is_active(3, 0));
  EXPECT_EQ(inbox.address(7), kSender);
}

TEST_F(InboxTest, LeaveEndsBindingAndSubscription) {
  const auto leave = [](std::uint16_t robot) { return patched<std::uint16_t>(leave_example(), 6, robot); };
  EXPECT_EQ(send(leave(8)), PacketStatus::unknown_robot);
  EXPECT_EQ(send(leave(7)), PacketStatus::stale);  // no state before
  send(v2v(7, 5));
  send(subscribe(0, 1u << 2));
  EXPECT_EQ(send(leave(7), 1, kOtherSender), PacketStatus::wrong_source);
  EXPECT_TRUE(inbox.is_active(7, 1));
  EXPECT_EQ(send(leave(7), 1), PacketStatus::accepted);
  EXPECT_FALSE(inbox.is_active(7, 1));
  EXPECT_FALSE(inbox.address(7));
  EXPECT_EQ(send(v2v(7, 0), 2, kOtherSender), PacketStatus::accepted);
  EXPECT_TRUE(inbox.is_subscribed(7, kLaser, 2));  // all types, not the subscription of the previous sender
  EXPECT_EQ(inbox.address(7), kOtherSender);
}

TEST_F(InboxTest, ReportsTheIdUsedByStrangers) {
  send(v2v(7, 0));
  EXPECT_EQ(send(v2v(7, 1), 0, kOtherSender), PacketStatus::wrong_source);
  EXPECT_EQ(packet.header.robot, 7);
  EXPECT_EQ(packet.header.sequence, 1u);
}

TEST_F(InboxTest, AcceptsAnAddressOnceItReturnsItsToken) {
  base::Bytes answer;
  base::Bytes request = subscribe(0, 1u << kLaser);
  write_session_token(request, {kSession, 0});
  EXPECT_EQ(inbox.accept(request, kSender, 0, packet), PacketStatus::unproven);
  EXPECT_FALSE(inbox.is_active(7, 0) || inbox.address(7));  // no packets are sent there
  ASSERT_TRUE(inbox.challenge(packet, kSender, 0, answer));
  EXPECT_LE(answer.size(), request.size());  // not larger than the request
  Packet challenge;
  ASSERT_EQ(decode(answer, challenge), PacketStatus::accepted);
  EXPECT_EQ(challenge.header.robot, 7);
  EXPECT_EQ(challenge.header.token, kSession);  // identifies the challenged robot
  const std::uint32_t token = std::get<Challenge>(challenge.body).token;
  write_session_token(request, {kSession, token});
  EXPECT_EQ(inbox.accept(request, kOtherSender, 0, packet), PacketStatus::unproven);  // valid for one address only
  EXPECT_EQ(inbox.accept(request, {kLoopback + 1, kSender.port}, 0, packet), PacketStatus::unproven);
  EXPECT_EQ(inbox.accept(request, kSender, 0, packet), PacketStatus::accepted);
  EXPECT_EQ(inbox.session_token_for(7).token, kSession);
  EXPECT_EQ(inbox.session_token_for(7).session, challenge.header.session);
  EXPECT_EQ(Inbox(options()).accept(request, kSender, 0, packet),
            PacketStatus::unproven);  // a restarted farm
}

/// Forged sources do not bind, block or release an id.
TEST_F(InboxTest, ForgedAddressesHaveNoEffect) {
  base::Bytes forged = v2v(7, 5);
  EXPECT_EQ(inbox.accept(forged, kOtherSender, 0, packet), PacketStatus::unproven);
  EXPECT_EQ(send(v2v(7, 0)), PacketStatus::accepted);
  EXPECT_EQ(inbox.accept(forged, kSender, 1, packet),
            PacketStatus::unproven);  // without a token no state of Alice is accepted
  base::Bytes leave = leave_example();
  write_session_token(leave, {kSession, inbox.token(kOtherSender)});
  EXPECT_EQ(inbox.accept(leave, kSender, 1, packet), PacketStatus::unproven);
  base::Bytes none;
  EXPECT_FALSE(inbox.challenge(packet, kSender, 1, none));  // a LEAVE gets no challenge
  EXPECT_TRUE(inbox.is_active(7, 1));
  // After LEAVE, and after two seconds, the next sender must prove its address, too.
  send(leave_example(), 2);
  EXPECT_EQ(inbox.accept(v2v(7, 9), kOtherSender, 3, packet), PacketStatus::unproven);
  EXPECT_EQ(inbox.accept(v2v(7, 9), kOtherSender, 5 * kSecond, packet), PacketStatus::unproven);
  EXPECT_FALSE(inbox.address(7));
  EXPECT_EQ(send(v2v(7, 9), 5 * kSecond, kOtherSender), PacketStatus::accepted);
}

TEST_F(InboxTest, LimitsChallengesPerTenthOfASecond) {
  base::Bytes out;
  inbox.accept(v2v(7, 0), kOtherSender, 0, packet);
  std::size_t answered = 0;
  for (int i = 0; i < 3000; ++i) answered += inbox.challenge(packet, kOtherSender, kSecond, out);
  EXPECT_EQ(answered, Inbox::kMaxChallenges);
  EXPECT_FALSE(inbox.challenge(packet, kOtherSender, kSecond + kSecond / 10 - 1, out));
  EXPECT_TRUE(inbox.challenge(packet, kOtherSender, kSecond + kSecond / 10, out));
}

TEST_F(InboxTest, LimitsChallengesSeparatelyWithAndWithoutKeys) {
  base::Bytes out, keyed = v2v(kKeyed, 0);
  sign(keyed, kKey, 1);
  EXPECT_EQ(inbox.accept(keyed, kSender, kSecond, packet), PacketStatus::unproven);
  const Packet genuine = packet;
  inbox.accept(v2v(7, 0), kOtherSender, kSecond, packet);
  while (inbox.challenge(packet, kOtherSender, kSecond, out)) {
  }
  for (std::size_t i = 0; i < Inbox::kMaxChallenges; ++i)
    ASSERT_TRUE(inbox.challenge(genuine, kSender, kSecond, out)) << i;
  EXPECT_FALSE(inbox.challenge(genuine, kSender, kSecond, out)) << "their limit is separate";
}

TEST_F(InboxTest, TagsDoNotActivateRobots) {
  Inbox both({.bind = {kLoopback, 0}, .robots = {12}, .tags = {12}});
  EXPECT_EQ(both.accept(tag_example(), kSender, 0, packet), PacketStatus::accepted);
  EXPECT_FALSE(both.is_active(12, 0));
  base::Bytes state = v2v(12, 0);
  write_session_token(state, {0, both.token(kOtherSender)});
  EXPECT_EQ(both.accept(state, kOtherSender, 0, packet),
            PacketStatus::accepted);  // ids of tags are bound independently of those of robots
}

TEST_F(InboxTest, DefaultSubscriptionIncludesAllTypes) {
  EXPECT_FALSE(inbox.is_subscribed(7, kLaser, 0));   // not active
  EXPECT_FALSE(inbox.is_subscribed(99, kLaser, 0));  // unknown
  send(v2v(7, 0), 0);
  EXPECT_TRUE(inbox.is_subscribed(7, kLaser, 0));
  send(subscribe(0, 1u << 2), 0);
  EXPECT_FALSE(inbox.is_subscribed(7, kLaser, 0));
  EXPECT_TRUE(inbox.is_subscribed(7, 2, 0));
  send(v2v(7, 1), kSecond);  // states do not change the subscription
  EXPECT_FALSE(inbox.is_subscribed(7, kLaser, kSecond));
  send(subscribe(1, 0), kSecond);  // 0 selects all types again
  EXPECT_TRUE(inbox.is_subscribed(7, kLaser, kSecond));
  EXPECT_TRUE(inbox.is_subscribed(7, 31, kSecond));
}

TEST_F(InboxTest, SilenceResetsTheSubscription) {
  send(subscribe(0, 1u << 2), 0);
  send(v2v(7, 0), 2 * kSecond);
  EXPECT_TRUE(inbox.is_subscribed(7, kLaser, 2 * kSecond));
}

TEST_F(InboxTest, StrangersCannotSubscribe) {
  send(v2v(7, 0), 0);
  EXPECT_EQ(send(subscribe(0, 1u << 2), 0, kOtherSender), PacketStatus::wrong_source);
  EXPECT_TRUE(inbox.is_subscribed(7, kLaser, 0));
}

TEST_F(InboxTest, StatesOfOthersRequireSubscription) {
  send(v2v(7, 0), 0);
  EXPECT_FALSE(inbox.wants_neighbours(7, 0));  // states of robots are not included in "all types"
  send(subscribe(0, 0), 0);
  EXPECT_FALSE(inbox.wants_neighbours(7, 0));
  send(subscribe(1, kNeighboursBit), 0);
  EXPECT_TRUE(inbox.wants_neighbours(7, 0));
  EXPECT_FALSE(inbox.is_subscribed(7, kLaser, 0));  // no other type was requested
  send(subscribe(2, kNeighboursBit | 1u << kLaser), 0);
  EXPECT_TRUE(inbox.wants_neighbours(7, 0) && inbox.is_subscribed(7, kLaser, 0));
  EXPECT_FALSE(inbox.wants_neighbours(7, 2 * kSecond));  // silent
  EXPECT_FALSE(inbox.wants_neighbours(3, 0));            // no packet yet
  EXPECT_FALSE(inbox.wants_neighbours(99, 0));           // unknown
}

/// A light receives the robots near its claimed position, so it has to prove its address. The sender of an object
/// receives nothing.
TEST_F(InboxTest, LightsMustProveTheirAddressObjectsNeedNot) {
  InboxOptions lit = options();
  lit.lights = {2};
  Inbox crossing(lit);
  const auto send_as = [&](base::Bytes bytes, std::uint32_t token) {
    write_session_token(bytes, {kSession, token});
    return crossing.accept(bytes, kSender, 0, packet);
  };
  EXPECT_EQ(send_as(v2i_example(), 0), PacketStatus::unproven);
  EXPECT_FALSE(crossing.light_address(2, 0));
  EXPECT_EQ(send_as(v2i_example(), crossing.token(kSender)), PacketStatus::accepted);
  EXPECT_EQ(crossing.light_address(2, kSenderTimeout - 1), kSender);
  EXPECT_FALSE(crossing.light_address(2, kSenderTimeout)) << "silent";
  EXPECT_EQ(crossing.light_session_token(2).token, kSession);
  EXPECT_EQ(send_as(object_example(), 0), PacketStatus::accepted);
  EXPECT_EQ(send_as(object_example(), 0), PacketStatus::stale);
  EXPECT_EQ(send_as(tag_example(), 0), PacketStatus::accepted) << "a tag's camera is another sender";
  EXPECT_EQ(crossing.object_address(12), kSender);
}

TEST_F(InboxTest, AnySenderMayStartRobots) {
  send(v2v(7, 0), 0);
  EXPECT_EQ(send(start_example(), 0, kOtherSender), PacketStatus::accepted);  // from any source
  EXPECT_EQ(send(start_example(), 0, kOtherSender), PacketStatus::accepted);  // and again
  EXPECT_EQ(send(patched<std::uint16_t>(start_example(), 6, 3), 0, kOtherSender), PacketStatus::accepted);
  EXPECT_EQ(send(patched<std::uint16_t>(start_example(), 6, 8), 0, kOtherSender), PacketStatus::unknown_robot);
  EXPECT_FALSE(inbox.is_active(3, 0));  // START does not activate the robot
  EXPECT_EQ(inbox.address(7), kSender);
}

TEST_F(InboxTest, AMillionRandomAndMutatedDatagrams) {
  std::mt19937 random(20260101);  // NOLINT: the same datagrams every time
  std::vector<base::Bytes> seeds = all_examples();
  seeds.push_back(leave_of_keyed());
  seeds.push_back(signed_leave());
  seeds.push_back(proven_leave({kLoopback, 1}));
  std::uint64_t accepted = 0;
  base::Bytes bytes;
  for (int i = 0; i < 1'000'000; ++i) {
    if (i % 4 == 0) {
      bytes.resize(random() % 160);
      for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    } else {
      bytes = seeds[random() % seeds.size()];
      for (std::uint32_t edits = random() % 4; edits > 0; --edits)
        bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
      if (random() % 8 == 0) bytes.resize(random() % 200);
    }
    const Endpoint source{kLoopback, static_cast<std::uint16_t>(random() % 3)};
    if (random() % 8 != 0 && bytes.size() >= kHeaderBytes) write_session_token(bytes, {kSession, inbox.token(source)});
    const std::int64_t now = std::int64_t{i} * (kSecond / 100);
    if (inbox.accept(bytes, source, now, packet) != PacketStatus::accepted) continue;
    ++accepted;
    if (const auto* state = std::get_if<V2v>(&packet.body)) {
      ASSERT_LE(std::abs(state->X_WR.x), kMaxPosition);
      ASSERT_LE(std::abs(state->velocity.turn), kMaxSpeed);
    }
  }
  EXPECT_EQ(inbox.counts().total(), 1'000'000u);
  EXPECT_EQ(inbox.counts()[PacketStatus::accepted], accepted);
  for (std::size_t i = 0; i < kPacketStatuses; ++i)
    EXPECT_GT(inbox.counts().of[i], 0u) << name(static_cast<PacketStatus>(i));
}

struct LoopbackTest : testing::Test {
  Inbox inbox{options()};
  Outbox outbox;
  Endpoint to{kLoopback, inbox.port()};

  /// Receives until `count` datagrams have arrived; fails after ten million empty polls.
  std::vector<Packet> receive(std::size_t count, std::int64_t now) {
    std::vector<Packet> packets;
    std::size_t taken = 0;
    for (int visits = 0; taken < count && visits < 10'000'000; ++visits) {
      taken += inbox.receive(now, [&](const Packet& packet) { packets.push_back(packet); });
    }
    EXPECT_EQ(taken, count);
    return packets;
  }
};

TEST_F(LoopbackTest, StatesArriveWithTheirSender) {
  const Endpoint from{kLoopback, outbox.endpoint().port};
  outbox.queue(to, v2v_example(), {0, inbox.token(from)});
  outbox.queue(to, tag_example());
  outbox.queue(to, base::Bytes{});
  outbox.flush();
  const std::vector<Packet> packets = receive(3, 0);
  ASSERT_EQ(packets.size(), 2u);
  EXPECT_EQ(std::get<V2v>(packets[0].body).X_WR.x, 1.5);
  EXPECT_EQ(packets[1].header.robot, 12);
  EXPECT_EQ(inbox.counts()[PacketStatus::too_short], 1u);
  ASSERT_TRUE(inbox.address(7));
  EXPECT_EQ(*inbox.address(7), (Endpoint{kLoopback, outbox.endpoint().port}));
}

TEST_F(LoopbackTest, PortInUseIsAnError) {
  const std::string error = refusal_of([&] { Inbox({.bind = {kLoopback, inbox.port()}}); });
  expect_in("127.0.0.1:" + std::to_string(inbox.port()), error);
  expect_in("choose another port", error);
}

TEST(Inbox, ForeignAddressIsAnError) { EXPECT_THROW(Inbox({.bind = {resolve("192.0.2.1"), 0}}), base::InputError); }

TEST(Inbox, RejectsIdsThatDoNotFitAPacket) {
  EXPECT_THROW(Inbox({.bind = {kLoopback, 0}, .robots = {65'536}}), base::InputError);
  EXPECT_THROW(Inbox({.bind = {kLoopback, 0}, .tags = {0}}), base::InputError);
}

TEST(Inbox, BindsToLoopbackByDefault) { EXPECT_EQ(InboxOptions{}.bind, (Endpoint{0x7F000001u, 9000})); }

}  // namespace
}  // namespace sf::netio
