#include "raycast/cell_cache.h"

#include <algorithm>
#include <bit>

#include "base/hash.h"

namespace sf::raycast {

CellCache::CellCache(std::uint32_t slots, std::uint32_t chunks, std::uint32_t page) : page_(page) {
  grow(slots, chunks);
}

void CellCache::grow(std::uint32_t slots, std::uint32_t chunks) {
  page_owners_.resize(std::max<std::size_t>(page_owners_.size(), chunks / page_), kNone);
  if (slots <= slots_.size()) return;
  slots_.resize(slots);
  table_.assign(std::bit_ceil(2u * slots), kNone);
  for (std::uint32_t number = 0; number < slots; ++number)
    if (slots_[number].used) insert_key(number);
}

void CellCache::insert_key(std::uint32_t number) {
  std::size_t at = bucket_of(slots_[number].key);
  while (table_[at] != kNone) at = (at + 1) & (table_.size() - 1);
  table_[at] = number;
}

std::size_t CellCache::bucket_of(const CellKey& key) const {
  return base::hash_bytes(&key, sizeof key) & (table_.size() - 1);
}

std::uint32_t CellCache::slot_of(const CellKey& key, std::uint32_t guess) const {
  if (guess < slots_.size() && slots_[guess].used && slots_[guess].key == key) return guess;
  for (std::size_t at = bucket_of(key); table_[at] != kNone; at = (at + 1) & (table_.size() - 1))
    if (slots_[table_[at]].key == key) return table_[at];
  return kNone;
}

std::uint32_t CellCache::find(const CellKey& key) {
  const std::uint32_t slot = slot_of(key);
  if (slot != kNone) slots_[slot].tick = tick_;
  return slot;
}

std::uint32_t CellCache::insert(const CellKey& key, std::uint32_t chunks) {
  const std::uint32_t pages = (chunks + page_ - 1) / page_;
  const std::uint32_t page = free_pages(pages);
  if (page == kNone) return kNone;
  const std::uint32_t number = free_slot();
  if (number == kNone) return kNone;
  slots_[number] = {key, page, pages, tick_, true};
  for (std::uint32_t i = page; i < page + pages; ++i) page_owners_[i] = number;
  next_page_ = page + pages;
  ++used_;
  ++built_;
  insert_key(number);
  return number;
}

std::uint32_t CellCache::free_pages(std::uint32_t pages) {
  const auto all = static_cast<std::uint32_t>(page_owners_.size());
  if (pages > all) return kNone;
  std::uint32_t tried = 0;
  std::uint32_t start = next_page_ + pages <= all ? next_page_ : 0;
  std::uint32_t end = start;
  while (end < start + pages) {
    const std::uint32_t owner = page_owners_[end];
    if (owner == kNone || slots_[owner].tick != tick_) {
      ++end;
      continue;
    }
    // This tick uses the owner's pages; continue after them.
    const std::uint32_t behind = slots_[owner].first_page + slots_[owner].pages;
    tried += behind - start;
    start = behind + pages <= all ? behind : 0;
    if (start == 0) tried += all - behind;
    if (tried > 2 * all) return kNone;
    end = start;
  }
  for (std::uint32_t i = start; i < start + pages; ++i)
    if (page_owners_[i] != kNone) evict(page_owners_[i]);
  return start;
}

std::uint32_t CellCache::free_slot() {
  for (std::size_t tries = 0; tries < slots_.size(); ++tries) {
    clock_hand_ = clock_hand_ + 1 < slots_.size() ? clock_hand_ + 1 : 0;
    Slot& slot = slots_[clock_hand_];
    if (slot.used && slot.tick == tick_) continue;
    if (slot.used) evict(clock_hand_);
    return clock_hand_;
  }
  return kNone;
}

void CellCache::evict(std::uint32_t number) {
  Slot& slot = slots_[number];
  for (std::uint32_t i = slot.first_page; i < slot.first_page + slot.pages; ++i) page_owners_[i] = kNone;
  slot.used = false;
  --used_;

  // Open addressing without tombstones: entries displaced by the removed one move back.
  const std::size_t mask = table_.size() - 1;
  std::size_t hole = bucket_of(slot.key);
  while (table_[hole] != number) hole = (hole + 1) & mask;
  for (std::size_t at = (hole + 1) & mask; table_[at] != kNone; at = (at + 1) & mask) {
    const std::size_t home = bucket_of(slots_[table_[at]].key);
    if (((at - home) & mask) < ((at - hole) & mask)) continue;
    table_[hole] = table_[at];
    hole = at;
  }
  table_[hole] = kNone;
}

}  // namespace sf::raycast
