#include "netio/track.h"

#include <gtest/gtest.h>

#include <initializer_list>

namespace sf::netio {
namespace {

Track after(std::initializer_list<std::uint64_t> indices) {
  Track track;
  for (const std::uint64_t index : indices) see(track, index);
  return track;
}

TEST(Track, NothingSeenNothingLost) { EXPECT_EQ(lost(Track{}), 0u); }

TEST(Track, InOrder) {
  const Track track = after({0, 1, 2, 3});
  EXPECT_EQ(track.unique, 4u);
  EXPECT_EQ(lost(track), 0u);
  EXPECT_EQ(track.duplicates + track.reordered, 0u);
}

TEST(Track, LossBeforeTheFirstArrivalCounts) { EXPECT_EQ(lost(after({3, 4})), 3u); }

TEST(Track, AGapIsLoss) { EXPECT_EQ(lost(after({0, 1, 5})), 3u); }

TEST(Track, ALateOneFillsItsGap) {
  const Track track = after({0, 2, 1, 3});
  EXPECT_EQ(lost(track), 0u);
  EXPECT_EQ(track.reordered, 1u);
  EXPECT_EQ(track.duplicates, 0u);
}

TEST(Track, RepetitionsAreDuplicates) {
  const Track track = after({0, 0, 1, 2, 1, 2});
  EXPECT_EQ(track.duplicates, 3u);
  EXPECT_EQ(track.unique, 3u);
  EXPECT_EQ(lost(track), 0u);
}

TEST(Track, ADuplicateOfALateOneIsSeen) { EXPECT_EQ(after({0, 5, 2, 2}).duplicates, 1u); }

TEST(Track, TheWindowEndsAfter64) {
  Track track = after({0, 63});
  see(track, 0);  // 63 behind: remembered
  EXPECT_EQ(track.duplicates, 1u);
  track = after({0, 64});
  see(track, 0);  // 64 behind: forgotten
  EXPECT_EQ(track.duplicates, 0u);
  EXPECT_EQ(track.reordered, 1u);
}

TEST(Track, JumpsForgetTheWindow) {
  for (const std::uint64_t jump : {63ull, 64ull, 65ull, 1000ull}) {
    Track track = after({0, jump});
    see(track, jump - 1);
    EXPECT_EQ(track.duplicates, 0u) << jump;
    EXPECT_EQ(lost(track), jump - 2) << jump;
  }
}

}  // namespace
}  // namespace sf::netio
