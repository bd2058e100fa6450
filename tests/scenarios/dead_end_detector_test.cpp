#include "scenarios/dead_end_detector.h"

#include <gtest/gtest.h>

namespace sf::scenarios {
namespace {

constexpr double kLength = 0.33;       // [m]
constexpr double kDetectorTick = 0.1;  // [s]

base::Report at(double x, double forward, double turn) {
  return {.X_WM = {x, 0.0, 0.0, 0.0}, .velocity = {forward, 0.0, turn}};
}

/// Turns to alternating sides, one second each, at x, x + step, ...
DeadEndDetector after_turns(int turns, double step) {
  DeadEndDetector ends(kLength, kDetectorTick);
  for (int k = 0; k < turns; ++k)
    for (int i = 0; i < 10; ++i) ends.update(at(k * step, 0.0, k % 2 == 0 ? 0.5 : -0.5), false);
  return ends;
}

/// Seven turns have six reversals.
TEST(DeadEndDetector, BeginsAtTheSixthReversal) {
  EXPECT_EQ(after_turns(6, 0.0).count(), 0u);
  EXPECT_EQ(after_turns(6, 0.0).stuck(), 0.0);
  EXPECT_EQ(after_turns(7, 0.0).count(), 1u);
}

/// From the first reversal at 1.1 s to the end: 60 ticks, and the rest of the last turn.
TEST(DeadEndDetector, LastsFromTheFirstReversalOn) { EXPECT_NEAR(after_turns(7, 0.0).stuck(), 5.9, 0.05); }

TEST(DeadEndDetector, StayingInItIsOneDeadEnd) { EXPECT_EQ(after_turns(60, 0.0).count(), 1u); }

/// With a body's length between turns, no two turns are at the same place.
TEST(DeadEndDetector, ZigzagsThatMakeProgressAreNotCounted) {
  EXPECT_EQ(after_turns(60, 0.34).count(), 0u);
  EXPECT_EQ(after_turns(60, 0.34).stuck(), 0.0);
  EXPECT_GT(after_turns(60, 0.04).count(), 0u);
}

TEST(DeadEndDetector, EndsABodysLengthAway) {
  DeadEndDetector ends = after_turns(7, 0.0);
  const double stuck = ends.stuck();
  ends.update(at(0.32, 0.1, 0.0), false);
  EXPECT_NEAR(ends.stuck(), stuck + kDetectorTick, 1e-9);
  ends.update(at(0.34, 0.1, 0.0), false);
  ends.update(at(0.0, 0.1, 0.0), false);
  EXPECT_NEAR(ends.stuck(), stuck + kDetectorTick, 1e-9);
}

/// Turns by a supervisor in the same passage do not end a dead end.
TEST(DeadEndDetector, TurnsBySupervisorsCount) {
  DeadEndDetector ends(kLength, kDetectorTick);
  for (int k = 0; k < 7; ++k) {
    for (int i = 0; i < 10; ++i) ends.update(at(0.0, 0.0, 0.0), true);
    ends.turned_by_hand(at(0.0, 0.0, 0.0), k % 2 == 0 ? 0.7 : -0.7);
  }
  EXPECT_EQ(ends.count(), 1u);
  EXPECT_NEAR(ends.standing_in_contact(), 7.0, 1e-9);
  EXPECT_NEAR(ends.stuck(), 7.0, 1e-9);
}

/// Turns to one side and curves do not count.
TEST(DeadEndDetector, OnlyReversalsOfTurnsInPlaceCount) {
  DeadEndDetector ends(kLength, kDetectorTick);
  for (int i = 0; i < 500; ++i) ends.update(at(0.0, 0.0, 0.5), false);
  for (int i = 0; i < 500; ++i) ends.update(at(0.0, 0.01, i % 2 == 0 ? 0.5 : -0.5), false);
  EXPECT_EQ(ends.count(), 0u);
  EXPECT_EQ(ends.stuck(), 0.0);
}

TEST(DeadEndDetector, WaitingInContactIsStuckButNotADeadEnd) {
  DeadEndDetector ends(kLength, kDetectorTick);
  for (int i = 0; i < 50; ++i) ends.update(at(0.0, 0.0, 0.0), true);
  for (int i = 0; i < 50; ++i) ends.update(at(0.0, 0.0, 0.0), false);
  EXPECT_EQ(ends.count(), 0u);
  EXPECT_NEAR(ends.stuck(), 5.0, 1e-9);
}

/// Waiting between reversals is counted once.
TEST(DeadEndDetector, NothingIsCountedTwice) {
  DeadEndDetector ends(kLength, kDetectorTick);
  int ticks = 0;
  for (int k = 0; k < 8; ++k) {
    for (int i = 0; i < 10; ++i, ++ticks) ends.update(at(0.0, 0.0, k % 2 == 0 ? 0.5 : -0.5), false);
    for (int i = 0; i < 10; ++i, ++ticks) ends.update(at(0.0, 0.0, 0.0), true);
  }
  EXPECT_EQ(ends.count(), 1u);
  EXPECT_LE(ends.stuck(), ticks * kDetectorTick + 1e-9);
  EXPECT_GE(ends.stuck(), (ticks - 20) * kDetectorTick - 1e-9);
}

}  // namespace
}  // namespace sf::scenarios
