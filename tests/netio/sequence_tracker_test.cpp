#include "netio/sequence_tracker.h"

#include <gtest/gtest.h>

#include <initializer_list>

namespace sf::netio {
namespace {

SequenceTracker after(std::initializer_list<std::uint64_t> indices) {
  SequenceTracker tracker;
  for (const std::uint64_t index : indices) count_arrival(tracker, index);
  return tracker;
}

TEST(SequenceTracker, ReportsNoLossWithoutArrivals) { EXPECT_EQ(lost(SequenceTracker{}), 0u); }

TEST(SequenceTracker, InOrder) {
  const SequenceTracker tracker = after({0, 1, 2, 3});
  EXPECT_EQ(tracker.unique, 4u);
  EXPECT_EQ(lost(tracker), 0u);
  EXPECT_EQ(tracker.duplicates + tracker.reordered, 0u);
}

TEST(SequenceTracker, NothingBeforeTheFirstArrivalIsLost) {
  EXPECT_EQ(lost(after({3, 4})), 0u) << "the receiver started later";
  EXPECT_EQ(lost(after({3, 6})), 2u);
  EXPECT_EQ(lost(after({3, 2})), 0u) << "reordered";
  EXPECT_EQ(lost(after({3, 1})), 1u) << "2, between them";
}

TEST(SequenceTracker, GapCountsAsLoss) { EXPECT_EQ(lost(after({0, 1, 5})), 3u); }

TEST(SequenceTracker, LateArrivalFillsItsGap) {
  const SequenceTracker tracker = after({0, 2, 1, 3});
  EXPECT_EQ(lost(tracker), 0u);
  EXPECT_EQ(tracker.reordered, 1u);
  EXPECT_EQ(tracker.duplicates, 0u);
}

TEST(SequenceTracker, RepetitionsAreDuplicates) {
  const SequenceTracker tracker = after({0, 0, 1, 2, 1, 2});
  EXPECT_EQ(tracker.duplicates, 3u);
  EXPECT_EQ(tracker.unique, 3u);
  EXPECT_EQ(lost(tracker), 0u);
}

TEST(SequenceTracker, DetectsDuplicateOfALateArrival) { EXPECT_EQ(after({0, 5, 2, 2}).duplicates, 1u); }

TEST(SequenceTracker, WindowHolds64Indices) {
  SequenceTracker tracker = after({0, 63});
  count_arrival(tracker, 0);  // 63 behind: remembered
  EXPECT_EQ(tracker.duplicates, 1u);
  tracker = after({0, 64});
  count_arrival(tracker, 0);  // 64 behind: forgotten
  EXPECT_EQ(tracker.duplicates, 0u);
  EXPECT_EQ(tracker.reordered, 1u);
}

TEST(SequenceTracker, JumpsClearTheWindow) {
  for (const std::uint64_t jump : {63ull, 64ull, 65ull, 1000ull}) {
    SequenceTracker tracker = after({0, jump});
    count_arrival(tracker, jump - 1);
    EXPECT_EQ(tracker.duplicates, 0u) << jump;
    EXPECT_EQ(lost(tracker), jump - 2) << jump;
    EXPECT_EQ(after({0, 1, jump + 1, jump}).duplicates, 0u) << jump;  // no earlier index takes its place
  }
}

}  // namespace
}  // namespace sf::netio
