#include "netio/sender_bindings.h"
#include "tests/units.h"

#include <gtest/gtest.h>

#include <array>

namespace sf::netio {
namespace {

constexpr Endpoint kAlice{kLoopback, 5001};
constexpr Endpoint kBob{kLoopback, 5002};
constexpr Endpoint kAliceElsewhere{kLoopback + 1, 5001};

struct SenderBindingsTest : testing::Test {
  SenderBindings bindings{std::array<std::uint32_t, 3>{7, 0, 40'000}};
  PacketStatus send(const Endpoint& who, std::uint32_t sequence, std::int64_t now, std::size_t line = 0) {
    return bindings.admit(7, line, sequence, who, now);
  }
};

TEST_F(SenderBindingsTest, AcceptsOnlyItsIds) {
  EXPECT_EQ(bindings.row(0), 0u);
  EXPECT_EQ(bindings.row(7), 1u);
  EXPECT_EQ(bindings.row(40'000), 2u);
  EXPECT_FALSE(bindings.row(1));
  EXPECT_FALSE(bindings.row(0xFFFFFFFFu));
  EXPECT_FALSE(bindings.is_active(1, 0));
  EXPECT_FALSE(bindings.source(1));
}

TEST_F(SenderBindingsTest, HasThreeChannels) {
  EXPECT_EQ(send(kAlice, 0, 0, 2), PacketStatus::accepted);
  EXPECT_DEATH(send(kAlice, 0, 0, 3), "id 7, line 3");
}

TEST_F(SenderBindingsTest, NoSenderIsActiveBeforeSending) {
  EXPECT_FALSE(bindings.is_active(7, 0));
  EXPECT_FALSE(bindings.source(7));
}

TEST_F(SenderBindingsTest, TheFirstSenderBinds) {
  EXPECT_EQ(send(kAlice, 0, 0), PacketStatus::accepted);
  EXPECT_EQ(send(kBob, 1, 1), PacketStatus::wrong_source);             // another port
  EXPECT_EQ(send(kAliceElsewhere, 1, 1), PacketStatus::wrong_source);  // another address
  EXPECT_EQ(bindings.source(7), kAlice);
  EXPECT_FALSE(bindings.is_active(0, 1));  // other ids are unaffected
}

TEST_F(SenderBindingsTest, TwoSecondsOfSilenceReleaseTheId) {
  EXPECT_EQ(send(kAlice, 10, 5 * kSecond), PacketStatus::accepted);
  EXPECT_TRUE(bindings.is_active(7, 7 * kSecond - 1));
  EXPECT_EQ(send(kBob, 0, 7 * kSecond - 1), PacketStatus::wrong_source);  // one nanosecond early
  EXPECT_FALSE(bindings.is_active(7, 7 * kSecond));
  EXPECT_EQ(bindings.source(7), kAlice);  // still known while silent
  EXPECT_EQ(send(kBob, 0, 7 * kSecond), PacketStatus::accepted);
  EXPECT_EQ(bindings.source(7), kBob);
  EXPECT_EQ(send(kAlice, 11, 7 * kSecond + 1), PacketStatus::wrong_source);
}

TEST_F(SenderBindingsTest, EachPacketRenewsTheBinding) {
  for (int i = 0; i < 10; ++i)
    EXPECT_EQ(send(kAlice, static_cast<std::uint32_t>(i), i * (2 * kSecond - 1)), PacketStatus::accepted);
  EXPECT_EQ(send(kBob, 99, 9 * (2 * kSecond - 1) + kSecond), PacketStatus::wrong_source);
}

TEST_F(SenderBindingsTest, WrongSourcesDoNotRenewTheBinding) {
  send(kAlice, 0, 0);
  send(kBob, 1, kSecond);
  EXPECT_FALSE(bindings.is_active(7, 2 * kSecond));
}

TEST_F(SenderBindingsTest, OldAndRepeatedSequencesAreStale) {
  EXPECT_EQ(send(kAlice, 100, 0), PacketStatus::accepted);
  EXPECT_EQ(send(kAlice, 100, 1), PacketStatus::stale);     // a duplicate
  EXPECT_EQ(send(kAlice, 99, 2), PacketStatus::stale);      // late
  EXPECT_EQ(send(kAlice, 102, 3), PacketStatus::accepted);  // one lost
  EXPECT_EQ(send(kAlice, 101, 4), PacketStatus::stale);     // the lost one arrives
}

TEST_F(SenderBindingsTest, SequencesWrap) {
  EXPECT_EQ(send(kAlice, 0xFFFFFFFFu, 0), PacketStatus::accepted);
  EXPECT_EQ(send(kAlice, 0, 1), PacketStatus::accepted);
  EXPECT_EQ(send(kAlice, 0x7FFFFFFFu, 2), PacketStatus::accepted);  // the largest distance ahead
  EXPECT_EQ(send(kAlice, 0xFFFFFFFFu, 3), PacketStatus::stale);     // half the range does not count as ahead
}

TEST_F(SenderBindingsTest, RestartedSenderIsAcceptedAfterTwoSeconds) {
  EXPECT_EQ(send(kAlice, 5000, 0), PacketStatus::accepted);
  for (int tick = 1; tick < 20; ++tick)
    EXPECT_EQ(send(kAlice, static_cast<std::uint32_t>(tick), tick * kSecond / 10), PacketStatus::stale);
  EXPECT_FALSE(bindings.is_active(7, 2 * kSecond));
  EXPECT_EQ(send(kAlice, 20, 2 * kSecond), PacketStatus::accepted);
}

TEST_F(SenderBindingsTest, ChannelsHaveSeparateSequences) {
  EXPECT_EQ(send(kAlice, 5000, 0, 0), PacketStatus::accepted);
  EXPECT_EQ(send(kAlice, 0, 1, 1), PacketStatus::accepted);    // SUBSCRIBE has its own sequence
  EXPECT_EQ(send(kBob, 1, 2, 1), PacketStatus::wrong_source);  // and the same binding
  EXPECT_EQ(send(kAlice, 1, kSecond, 1), PacketStatus::accepted);
  EXPECT_EQ(send(kAlice, 0, kSecond, 0), PacketStatus::stale);
  EXPECT_EQ(send(kAlice, 2, 2 * kSecond, 1), PacketStatus::accepted);
  EXPECT_EQ(send(kAlice, 0, 2 * kSecond, 0),
            PacketStatus::accepted);  // this channel was silent, but the other one kept the binding
}

TEST_F(SenderBindingsTest, LeaveReleasesTheIdAtOnce) {
  send(kAlice, 10, 0);
  EXPECT_EQ(bindings.leave(7, kAlice, 1), PacketStatus::accepted);
  EXPECT_FALSE(bindings.is_active(7, 1));
  EXPECT_FALSE(bindings.source(7));
  EXPECT_EQ(send(kBob, 0, 1), PacketStatus::accepted);  // in the same nanosecond, with a new sequence
  EXPECT_EQ(bindings.source(7), kBob);
  EXPECT_EQ(send(kAlice, 11, 2), PacketStatus::wrong_source);
}

TEST_F(SenderBindingsTest, PacketOvertakenByLeaveDoesNotBind) {
  send(kAlice, 10, 0);
  bindings.leave(7, kAlice, kSecond);
  EXPECT_EQ(send(kAlice, 9, kSecond), PacketStatus::stale);
  EXPECT_EQ(send(kAlice, 11, 3 * kSecond - 1), PacketStatus::stale);    // sent before LEAVE, or returning too soon
  EXPECT_EQ(send(kAlice, 0, 3 * kSecond - 1, 1), PacketStatus::stale);  // also on the other channel
  EXPECT_FALSE(bindings.is_active(7, 3 * kSecond - 1));
  EXPECT_EQ(send(kAlice, 0, 3 * kSecond), PacketStatus::accepted);  // accepted again after two seconds
}

TEST_F(SenderBindingsTest, OnlyTheBoundSenderCanLeave) {
  EXPECT_EQ(bindings.leave(7, kAlice, 0), PacketStatus::stale);  // no binding
  send(kAlice, 0, 0);
  EXPECT_EQ(bindings.leave(7, kBob, 1), PacketStatus::wrong_source);
  EXPECT_TRUE(bindings.is_active(7, 1));
  EXPECT_EQ(bindings.leave(7, kAlice, 2), PacketStatus::accepted);
  EXPECT_EQ(bindings.leave(7, kAlice, 3), PacketStatus::stale);  // repeated
  send(kBob, 0, 4);
  EXPECT_EQ(bindings.leave(7, kBob, 4 + 2 * kSecond), PacketStatus::stale);  // already silent
}

TEST_F(SenderBindingsTest, TheLastSenderRenewsWithoutOrder) {
  EXPECT_EQ(bindings.renew(7, kAlice, 0), PacketStatus::stale);  // never bound
  send(kAlice, 10, 0);
  EXPECT_EQ(bindings.renew(7, kBob, kSecond), PacketStatus::wrong_source);
  EXPECT_EQ(bindings.renew(7, kAlice, kSecond), PacketStatus::accepted);
  EXPECT_TRUE(bindings.is_active(7, 3 * kSecond - 1));
  EXPECT_EQ(bindings.renew(7, kBob, 3 * kSecond), PacketStatus::stale);       // silent, but not bound to this one
  EXPECT_EQ(bindings.renew(7, kAlice, 9 * kSecond), PacketStatus::accepted);  // after a silence
  EXPECT_EQ(send(kAlice, 11, 9 * kSecond), PacketStatus::accepted);           // the sequence continues
  bindings.leave(7, kAlice, 9 * kSecond);
  EXPECT_EQ(bindings.renew(7, kAlice, 9 * kSecond), PacketStatus::stale);
}

TEST_F(SenderBindingsTest, HandlesExtremeClockValues) {
  EXPECT_EQ(send(kAlice, 0, INT64_MAX - 1), PacketStatus::accepted);
  EXPECT_TRUE(bindings.is_active(7, INT64_MAX));
}

}  // namespace
}  // namespace sf::netio
