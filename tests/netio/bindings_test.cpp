#include "netio/bindings.h"

#include <gtest/gtest.h>

#include <array>

namespace sf::netio {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr Endpoint kAlice{kLoopback, 5001};
constexpr Endpoint kBob{kLoopback, 5002};
constexpr Endpoint kAliceElsewhere{kLoopback + 1, 5001};

struct Bound : testing::Test {
  Bindings bindings{std::array<std::uint32_t, 3>{7, 0, 40'000}};
  Reason say(const Endpoint& who, std::uint32_t sequence, std::int64_t now, std::size_t line = 0) {
    return bindings.admit(7, line, sequence, who, now);
  }
};

TEST_F(Bound, KnowsItsIdsOnly) {
  EXPECT_EQ(bindings.row(0), 0u);
  EXPECT_EQ(bindings.row(7), 1u);
  EXPECT_EQ(bindings.row(40'000), 2u);
  EXPECT_FALSE(bindings.row(1));
  EXPECT_FALSE(bindings.row(0xFFFFFFFFu));
  EXPECT_FALSE(bindings.heard(1, 0));
  EXPECT_FALSE(bindings.source(1));
}

TEST_F(Bound, NobodyIsHeardBeforeSpeaking) {
  EXPECT_FALSE(bindings.heard(7, 0));
  EXPECT_FALSE(bindings.source(7));
}

TEST_F(Bound, TheFirstSenderBinds) {
  EXPECT_EQ(say(kAlice, 0, 0), Reason::accepted);
  EXPECT_EQ(say(kBob, 1, 1), Reason::wrong_source);             // another port
  EXPECT_EQ(say(kAliceElsewhere, 1, 1), Reason::wrong_source);  // another address
  EXPECT_EQ(bindings.source(7), kAlice);
  EXPECT_FALSE(bindings.heard(0, 1));  // other ids are unmoved
}

TEST_F(Bound, TwoSecondsOfSilenceFree) {
  EXPECT_EQ(say(kAlice, 10, 5 * kSecond), Reason::accepted);
  EXPECT_TRUE(bindings.heard(7, 7 * kSecond - 1));
  EXPECT_EQ(say(kBob, 0, 7 * kSecond - 1), Reason::wrong_source);  // one nanosecond early
  EXPECT_FALSE(bindings.heard(7, 7 * kSecond));
  EXPECT_EQ(bindings.source(7), kAlice);  // still known while silent
  EXPECT_EQ(say(kBob, 0, 7 * kSecond), Reason::accepted);
  EXPECT_EQ(bindings.source(7), kBob);
  EXPECT_EQ(say(kAlice, 11, 7 * kSecond + 1), Reason::wrong_source);
}

TEST_F(Bound, EachPacketRenews) {
  for (int i = 0; i < 10; ++i)
    EXPECT_EQ(say(kAlice, static_cast<std::uint32_t>(i), i * (2 * kSecond - 1)), Reason::accepted);
  EXPECT_EQ(say(kBob, 99, 9 * (2 * kSecond - 1) + kSecond), Reason::wrong_source);
}

TEST_F(Bound, WrongSourcesDoNotRenew) {
  say(kAlice, 0, 0);
  say(kBob, 1, kSecond);
  EXPECT_FALSE(bindings.heard(7, 2 * kSecond));
}

TEST_F(Bound, OldAndRepeatedSequencesAreStale) {
  EXPECT_EQ(say(kAlice, 100, 0), Reason::accepted);
  EXPECT_EQ(say(kAlice, 100, 1), Reason::stale);     // a duplicate
  EXPECT_EQ(say(kAlice, 99, 2), Reason::stale);      // came late
  EXPECT_EQ(say(kAlice, 102, 3), Reason::accepted);  // one lost
  EXPECT_EQ(say(kAlice, 101, 4), Reason::stale);     // the lost one after all
}

TEST_F(Bound, SequencesWrap) {
  EXPECT_EQ(say(kAlice, 0xFFFFFFFFu, 0), Reason::accepted);
  EXPECT_EQ(say(kAlice, 0, 1), Reason::accepted);
  EXPECT_EQ(say(kAlice, 0x7FFFFFFFu, 2), Reason::accepted);  // the farthest that is ahead
  EXPECT_EQ(say(kAlice, 0xFFFFFFFFu, 3), Reason::stale);     // exactly half way round is not
}

TEST_F(Bound, ARestartedSenderIsBackAfterTwoSeconds) {
  EXPECT_EQ(say(kAlice, 5000, 0), Reason::accepted);
  for (int tick = 1; tick < 20; ++tick)
    EXPECT_EQ(say(kAlice, static_cast<std::uint32_t>(tick), tick * kSecond / 10), Reason::stale);
  EXPECT_FALSE(bindings.heard(7, 2 * kSecond));
  EXPECT_EQ(say(kAlice, 20, 2 * kSecond), Reason::accepted);
}

TEST_F(Bound, LinesCountApart) {
  EXPECT_EQ(say(kAlice, 5000, 0, 0), Reason::accepted);
  EXPECT_EQ(say(kAlice, 0, 1, 1), Reason::accepted);    // subscribes have their own count
  EXPECT_EQ(say(kBob, 1, 2, 1), Reason::wrong_source);  // and the same binding
  EXPECT_EQ(say(kAlice, 1, kSecond, 1), Reason::accepted);
  EXPECT_EQ(say(kAlice, 0, kSecond, 0), Reason::stale);
  EXPECT_EQ(say(kAlice, 2, 2 * kSecond, 1), Reason::accepted);
  EXPECT_EQ(say(kAlice, 0, 2 * kSecond, 0), Reason::accepted);  // this line was silent, the other kept the binding
}

TEST_F(Bound, WhoLeavesFreesItsIdAtOnce) {
  say(kAlice, 10, 0);
  EXPECT_EQ(bindings.leave(7, kAlice, 1), Reason::accepted);
  EXPECT_FALSE(bindings.heard(7, 1));
  EXPECT_FALSE(bindings.source(7));
  EXPECT_EQ(say(kBob, 0, 1), Reason::accepted);  // in the same nanosecond, counting from 0
  EXPECT_EQ(bindings.source(7), kBob);
  EXPECT_EQ(say(kAlice, 11, 2), Reason::wrong_source);
}

TEST_F(Bound, WhatALeaveOvertookBindsNobody) {
  say(kAlice, 10, 0);
  bindings.leave(7, kAlice, kSecond);
  EXPECT_EQ(say(kAlice, 9, kSecond), Reason::stale);
  EXPECT_EQ(say(kAlice, 11, 3 * kSecond - 1), Reason::stale);    // sent before, or it came back too soon
  EXPECT_EQ(say(kAlice, 0, 3 * kSecond - 1, 1), Reason::stale);  // of the other line too
  EXPECT_FALSE(bindings.heard(7, 3 * kSecond - 1));
  EXPECT_EQ(say(kAlice, 0, 3 * kSecond), Reason::accepted);  // after two seconds it may be heard again
}

TEST_F(Bound, OnlyTheBoundOneLeaves) {
  EXPECT_EQ(bindings.leave(7, kAlice, 0), Reason::stale);  // nobody was there
  say(kAlice, 0, 0);
  EXPECT_EQ(bindings.leave(7, kBob, 1), Reason::wrong_source);
  EXPECT_TRUE(bindings.heard(7, 1));
  EXPECT_EQ(bindings.leave(7, kAlice, 2), Reason::accepted);
  EXPECT_EQ(bindings.leave(7, kAlice, 3), Reason::stale);  // said twice
  say(kBob, 0, 4);
  EXPECT_EQ(bindings.leave(7, kBob, 4 + 2 * kSecond), Reason::stale);  // silent already
}

TEST_F(Bound, AClockAtItsEndsDoesNotMatter) {
  EXPECT_EQ(say(kAlice, 0, INT64_MAX - 1), Reason::accepted);
  EXPECT_TRUE(bindings.heard(7, INT64_MAX));
}

}  // namespace
}  // namespace sf::netio
