// Bookkeeping of the pool of cells: nothing needed is lost, nothing lost is found.

#include "raycast/cells.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "tests/sensors/chance.h"

namespace sf::raycast {
namespace {

constexpr std::uint32_t kPage = CellPool::kPage;

TEST(CellPool, FindsWhatWasInserted) {
  CellPool pool(8, 8 * kPage);
  const CellKey key{1, -5, 7};
  EXPECT_EQ(pool.find(key), CellPool::kNone);
  const std::uint32_t slot = pool.insert(key, 3);
  ASSERT_NE(slot, CellPool::kNone);
  EXPECT_EQ(pool.find(key), slot);
  EXPECT_EQ(pool.find({1, -5, 8}), CellPool::kNone);
  EXPECT_EQ(pool.find({2, -5, 7}), CellPool::kNone);
  EXPECT_EQ(pool.cells(), 1u);
  EXPECT_EQ(pool.built(), 1u);
}

TEST(CellPool, ACellWithoutChunksIsACellToo) {
  CellPool pool(4, kPage);
  ASSERT_NE(pool.insert({0, 0, 0}, 0), CellPool::kNone);
  ASSERT_NE(pool.insert({0, 1, 0}, kPage), CellPool::kNone);
  ASSERT_NE(pool.insert({0, 2, 0}, 0), CellPool::kNone);
  EXPECT_NE(pool.find({0, 0, 0}), CellPool::kNone);
  EXPECT_NE(pool.find({0, 2, 0}), CellPool::kNone);
}

TEST(CellPool, CellsDoNotShareChunks) {
  CellPool pool(16, 16 * kPage);
  std::set<std::uint32_t> pages;
  for (int i = 0; i < 5; ++i) {
    const std::uint32_t slot = pool.insert({0, i, 0}, kPage + 1);  // two pages each
    ASSERT_NE(slot, CellPool::kNone);
    const std::uint32_t first = pool.first_chunk(slot) / kPage;
    EXPECT_TRUE(pages.insert(first).second);
    EXPECT_TRUE(pages.insert(first + 1).second);
  }
}

/// This tick's cells are never evicted; when they fill the pool, the answer is kNone.
TEST(CellPool, RefusesRatherThanForgetWhatThisTickNeeds) {
  CellPool pool(64, 4 * kPage);
  for (int i = 0; i < 4; ++i) ASSERT_NE(pool.insert({0, i, 0}, kPage), CellPool::kNone);
  EXPECT_EQ(pool.insert({0, 9, 0}, 1), CellPool::kNone) << "no chunks left";
  for (int i = 0; i < 4; ++i) EXPECT_NE(pool.find({0, i, 0}), CellPool::kNone);

  CellPool few(3, 64 * kPage);
  for (int i = 0; i < 3; ++i) ASSERT_NE(few.insert({0, i, 0}, 1), CellPool::kNone);
  EXPECT_EQ(few.insert({0, 9, 0}, 1), CellPool::kNone) << "no slots left";
  EXPECT_EQ(CellPool(4, kPage).insert({0, 0, 0}, kPage + 1), CellPool::kNone) << "never fits";
}

TEST(CellPool, TheOldestMakesWay) {
  CellPool pool(64, 4 * kPage);
  for (int i = 0; i < 4; ++i) {
    pool.begin_tick();
    ASSERT_NE(pool.insert({0, i, 0}, kPage), CellPool::kNone);
  }
  pool.begin_tick();
  ASSERT_NE(pool.find({0, 1, 0}), CellPool::kNone);  // needed again now
  ASSERT_NE(pool.insert({0, 4, 0}, kPage), CellPool::kNone);
  ASSERT_NE(pool.insert({0, 5, 0}, kPage), CellPool::kNone);
  EXPECT_NE(pool.find({0, 1, 0}), CellPool::kNone) << "this tick needs it, though it came after the first";
  EXPECT_EQ(pool.find({0, 0, 0}), CellPool::kNone) << "the oldest";
  EXPECT_EQ(pool.find({0, 2, 0}), CellPool::kNone) << "the next in turn";
  EXPECT_NE(pool.find({0, 3, 0}), CellPool::kNone);
}

TEST(CellPool, GrowingKeepsWhatIsThere) {
  CellPool pool(4, 4 * kPage);
  std::map<int, std::uint32_t> slots;
  for (int i = 0; i < 4; ++i) slots[i] = pool.insert({3, i, -i}, kPage);
  ASSERT_EQ(pool.insert({3, 9, 9}, 1), CellPool::kNone);
  std::map<int, std::uint32_t> chunks;
  for (int i = 0; i < 4; ++i) chunks[i] = pool.first_chunk(slots[i]);
  pool.grow(64, 64 * kPage);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(pool.find({3, i, -i}), slots[i]);
    EXPECT_EQ(pool.first_chunk(slots[i]), chunks[i]);
  }
  for (int i = 4; i < 60; ++i) EXPECT_NE(pool.insert({3, i, -i}, kPage), CellPool::kNone) << i;
}

/// A million finds, inserts and evictions against a model. With few slots, chains of the table collide and are mended.
TEST(CellPool, AgreesWithAModelUnderChurn) {
  constexpr std::uint32_t kSlots = 13;
  constexpr std::uint32_t kPages = 40;
  CellPool pool(kSlots, kPages * kPage);
  trial::Chance chance(1);
  std::set<int> this_tick;
  std::map<int, std::uint32_t> claimed;  // pages of this tick's cells, by key
  for (int step = 0; step < 200'000; ++step) {
    if (chance.below(6) == 0) {
      pool.begin_tick();
      this_tick.clear();
      claimed.clear();
    }
    const int name = static_cast<int>(chance.below(60));
    const CellKey key{name % 3, name, -name};
    std::uint32_t slot = pool.find(key);
    ASSERT_FALSE(slot == CellPool::kNone && this_tick.contains(name)) << "lost what this tick needs";
    if (slot == CellPool::kNone) slot = pool.insert(key, static_cast<std::uint32_t>(name % 5) * kPage);
    if (slot == CellPool::kNone) continue;
    this_tick.insert(name);
    const auto pages = static_cast<std::uint32_t>(name % 5);
    claimed[name] = pool.first_chunk(slot) / kPage;
    ASSERT_LE(claimed[name] + pages, kPages);
    for (const auto& [other, first] : claimed) {
      if (other == name) continue;
      const auto size = static_cast<std::uint32_t>(other % 5);
      ASSERT_TRUE(pages == 0 || size == 0 || first + size <= claimed[name] || claimed[name] + pages <= first);
    }
    ASSERT_EQ(pool.find(key), slot);
    ASSERT_LE(pool.cells(), kSlots);
  }
  EXPECT_GT(pool.built(), 1000u);
}

}  // namespace
}  // namespace sf::raycast
