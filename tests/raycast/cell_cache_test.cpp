// Bookkeeping of the cell cache: cells in use are never lost, and evicted cells are never found.

#include "raycast/cell_cache.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "tests/sensors/chance.h"

namespace sf::raycast {
namespace {

constexpr std::uint32_t kPage = CellCache::kPage;

TEST(CellCache, FindsInsertedKeys) {
  CellCache cache(8, 8 * kPage);
  const CellKey key{1, -5, 7};
  EXPECT_EQ(cache.find(key), CellCache::kNone);
  const std::uint32_t slot = cache.insert(key, 3);
  ASSERT_NE(slot, CellCache::kNone);
  EXPECT_EQ(cache.find(key), slot);
  EXPECT_EQ(cache.find({1, -5, 8}), CellCache::kNone);
  EXPECT_EQ(cache.find({2, -5, 7}), CellCache::kNone);
  EXPECT_EQ(cache.cells(), 1u);
  EXPECT_EQ(cache.built(), 1u);
}

TEST(CellCache, WrongGuessesHaveNoEffect) {
  CellCache cache(2, 2 * kPage);
  const std::uint32_t p = cache.insert({0, 1, 0}, 1), q = cache.insert({0, 2, 0}, 1);
  for (const std::uint32_t guess : {p, q, 2u, CellCache::kNone}) {
    EXPECT_EQ(cache.slot_of({0, 1, 0}, guess), p) << guess;
    EXPECT_EQ(cache.slot_of({0, 3, 0}, guess), CellCache::kNone) << guess;
  }
  cache.begin_tick();
  cache.touch(q);
  EXPECT_EQ(cache.insert({0, 4, 0}, 1), p) << "in place of the first";
  EXPECT_EQ(cache.slot_of({0, 1, 0}, p), CellCache::kNone);
  EXPECT_EQ(cache.evicted(), 1u);
}

TEST(CellCache, SupportsCellsWithoutChunks) {
  CellCache cache(4, kPage);
  ASSERT_NE(cache.insert({0, 0, 0}, 0), CellCache::kNone);
  ASSERT_NE(cache.insert({0, 1, 0}, kPage), CellCache::kNone);
  ASSERT_NE(cache.insert({0, 2, 0}, 0), CellCache::kNone);
  EXPECT_NE(cache.find({0, 0, 0}), CellCache::kNone);
  EXPECT_NE(cache.find({0, 2, 0}), CellCache::kNone);
}

TEST(CellCache, CellsDoNotShareChunks) {
  CellCache cache(16, 16 * kPage);
  std::set<std::uint32_t> pages;
  for (int i = 0; i < 5; ++i) {
    const std::uint32_t slot = cache.insert({0, i, 0}, kPage + 1);  // two pages each
    ASSERT_NE(slot, CellCache::kNone);
    const std::uint32_t first = cache.first_chunk(slot) / kPage;
    EXPECT_TRUE(pages.insert(first).second);
    EXPECT_TRUE(pages.insert(first + 1).second);
  }
}

/// This tick's cells are never evicted. If they fill the pool, `insert` returns kNone.
TEST(CellCache, NeverEvictsCellsOfThisTick) {
  CellCache cache(64, 4 * kPage);
  for (int i = 0; i < 4; ++i) ASSERT_NE(cache.insert({0, i, 0}, kPage), CellCache::kNone);
  EXPECT_EQ(cache.insert({0, 9, 0}, 1), CellCache::kNone) << "no chunks left";
  for (int i = 0; i < 4; ++i) EXPECT_NE(cache.find({0, i, 0}), CellCache::kNone);

  CellCache few(3, 64 * kPage);
  for (int i = 0; i < 3; ++i) ASSERT_NE(few.insert({0, i, 0}, 1), CellCache::kNone);
  EXPECT_EQ(few.insert({0, 9, 0}, 1), CellCache::kNone) << "no slots left";
  EXPECT_EQ(CellCache(4, kPage).insert({0, 0, 0}, kPage + 1), CellCache::kNone) << "never fits";
}

TEST(CellCache, EvictsTheOldestCellFirst) {
  CellCache cache(64, 4 * kPage);
  for (int i = 0; i < 4; ++i) {
    cache.begin_tick();
    ASSERT_NE(cache.insert({0, i, 0}, kPage), CellCache::kNone);
  }
  cache.begin_tick();
  ASSERT_NE(cache.find({0, 1, 0}), CellCache::kNone);  // in use in this tick
  ASSERT_NE(cache.insert({0, 4, 0}, kPage), CellCache::kNone);
  ASSERT_NE(cache.insert({0, 5, 0}, kPage), CellCache::kNone);
  EXPECT_NE(cache.find({0, 1, 0}), CellCache::kNone) << "this tick needs it, though it came after the first";
  EXPECT_EQ(cache.find({0, 0, 0}), CellCache::kNone) << "the oldest";
  EXPECT_EQ(cache.find({0, 2, 0}), CellCache::kNone) << "the next in turn";
  EXPECT_NE(cache.find({0, 3, 0}), CellCache::kNone);
}

TEST(CellCache, GrowingKeepsCells) {
  CellCache cache(4, 4 * kPage);
  std::map<int, std::uint32_t> slots;
  for (int i = 0; i < 4; ++i) slots[i] = cache.insert({3, i, -i}, kPage);
  ASSERT_EQ(cache.insert({3, 9, 9}, 1), CellCache::kNone);
  std::map<int, std::uint32_t> chunks;
  for (int i = 0; i < 4; ++i) chunks[i] = cache.first_chunk(slots[i]);
  cache.grow(64, 64 * kPage);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(cache.find({3, i, -i}), slots[i]);
    EXPECT_EQ(cache.first_chunk(slots[i]), chunks[i]);
  }
  for (int i = 4; i < 60; ++i) EXPECT_NE(cache.insert({3, i, -i}, kPage), CellCache::kNone) << i;
}

/// Compares 200 000 finds, inserts and evictions with a model. With few slots, chains of the hash table collide and are
/// repaired.
TEST(CellCache, MatchesAModelUnderChurn) {
  constexpr std::uint32_t kSlots = 13;
  constexpr std::uint32_t kPages = 40;
  CellCache cache(kSlots, kPages * kPage);
  trial::Chance chance(1);
  std::set<int> this_tick;
  std::map<int, std::uint32_t> claimed;  // pages of this tick's cells, by key
  for (int step = 0; step < 200'000; ++step) {
    if (chance.below(6) == 0) {
      cache.begin_tick();
      this_tick.clear();
      claimed.clear();
    }
    const int name = static_cast<int>(chance.below(60));
    const CellKey key{name % 3, name, -name};
    std::uint32_t slot = cache.find(key);
    ASSERT_FALSE(slot == CellCache::kNone && this_tick.contains(name)) << "lost what this tick needs";
    if (slot == CellCache::kNone) slot = cache.insert(key, static_cast<std::uint32_t>(name % 5) * kPage);
    if (slot == CellCache::kNone) continue;
    this_tick.insert(name);
    const auto pages = static_cast<std::uint32_t>(name % 5);
    claimed[name] = cache.first_chunk(slot) / kPage;
    ASSERT_LE(claimed[name] + pages, kPages);
    for (const auto& [other, first] : claimed) {
      if (other == name) continue;
      const auto size = static_cast<std::uint32_t>(other % 5);
      ASSERT_TRUE(pages == 0 || size == 0 || first + size <= claimed[name] || claimed[name] + pages <= first);
    }
    ASSERT_EQ(cache.find(key), slot);
    ASSERT_LE(cache.cells(), kSlots);
  }
  EXPECT_GT(cache.built(), 1000u);
}

}  // namespace
}  // namespace sf::raycast
