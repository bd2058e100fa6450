#pragma once
// Which cells have their lists on the device: a pool of fixed size, built where robots are, oldest out first.

#include <cstdint>
#include <vector>

namespace sf::raycast {

/// Names one cell of one family of sensors.
struct CellKey {
  std::int64_t config = 0;  ///< which sensors share it, and whether viewpoints may lie inside solids
  std::int64_t x = 0;
  std::int64_t y = 0;
  bool operator==(const CellKey&) const = default;
};

/// Bookkeeping of the pool: which key owns which slot and which chunks. Knows nothing of what is in them.
///
/// Chunks are handed out in pages, round and round; what was there is forgotten, unless this tick needs it. Allocates
/// only to grow.
class CellCache {
 public:
  /// @param slots how many cells at most. @param chunks how many chunks of entries at most.
  /// @param page [chunks] that are handed out together
  CellCache(std::uint32_t slots, std::uint32_t chunks, std::uint32_t page = kPage);

  static constexpr std::uint32_t kNone = 0xFFFFFFFFu;
  static constexpr std::uint32_t kPage = 32;  ///< [chunks] unless told otherwise

  /// More room; never less. Keeps what is in it.
  void grow(std::uint32_t slots, std::uint32_t chunks);

  void begin_tick() { ++tick_; }
  /// The slot of `key`, kept for this tick, or kNone.
  std::uint32_t find(const CellKey& key);
  /// The slot of `key`, or kNone; may be asked by several threads at once.
  std::uint32_t slot_of(const CellKey& key) const;
  /// Keeps what is in `slot` for this tick.
  void touch(std::uint32_t slot) { slots_[slot].tick = tick_; }
  /// Room for `key` (not in the pool) with `chunks` chunks: its slot, or kNone when this tick's cells fill the pool.
  std::uint32_t insert(const CellKey& key, std::uint32_t chunks);

  std::uint32_t first_chunk(std::uint32_t slot) const { return slots_[slot].first_page * page_; }
  std::uint32_t slots() const { return static_cast<std::uint32_t>(slots_.size()); }
  std::uint32_t cells() const { return used_; }   ///< now in the pool
  std::uint64_t built() const { return built_; }  ///< ever inserted

 private:
  struct Slot {
    CellKey key;
    std::uint32_t first_page = 0;
    std::uint32_t pages = 0;
    std::uint64_t tick = 0;  ///< last tick that needed it
    bool used = false;
  };
  std::size_t bucket_of(const CellKey& key) const;
  void insert_key(std::uint32_t slot);
  void evict(std::uint32_t slot);
  std::uint32_t free_slot();
  std::uint32_t free_pages(std::uint32_t pages);

  std::uint32_t page_;
  std::vector<Slot> slots_;
  std::vector<std::uint32_t> table_;        ///< open addressing by key: a slot or kNone
  std::vector<std::uint32_t> page_owners_;  ///< by page: a slot or kNone
  std::uint32_t next_page_ = 0;             ///< page where the search for room goes on
  std::uint32_t clock_hand_ = 0;            ///< slot where the search for a free one goes on
  std::uint32_t used_ = 0;
  std::uint64_t built_ = 0;
  std::uint64_t tick_ = 1;
};

}  // namespace sf::raycast
