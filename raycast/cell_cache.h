#pragma once
// Cache of cells: a pool of fixed size. Cells are built at the sensors' positions, and the oldest are evicted first.

#include <cstdint>
#include <vector>

namespace sf::raycast {

/// Key of one cell of one list config at one interval of heights.
struct CellKey {
  std::int64_t config = 0;  ///< 2 * list config, plus 1 if viewpoints are inside solids
  std::int64_t x = 0;
  std::int64_t y = 0;
  std::int64_t level = 0;  ///< ListConfigs::level_of
  bool operator==(const CellKey&) const = default;
};

/// Bookkeeping of the pool: the slot and the chunks of each key. The caller stores the contents.
///
/// Chunks are allocated in pages from a ring. Pages that this tick does not use are evicted. Only the constructor and
/// `grow` allocate memory.
class CellCache {
 public:
  /// @param slots largest number of cells  @param chunks largest number of chunks of entries
  /// @param page [chunks] unit of allocation
  CellCache(std::uint32_t slots, std::uint32_t chunks, std::uint32_t page = kPage);

  static constexpr std::uint32_t kNone = 0xFFFFFFFFu;
  static constexpr std::uint32_t kPage = 32;  ///< [chunks] default page

  /// Enlarges the pool, never shrinks it. Keeps its cells.
  void grow(std::uint32_t slots, std::uint32_t chunks);

  void begin_tick() { ++tick_; }
  /// Returns the slot of `key` and marks it as used in this tick; kNone if absent.
  std::uint32_t find(const CellKey& key);
  /// Returns the slot of `key`; kNone if absent. Safe to call from several readers at once. @param guess its likely
  /// slot, or kNone
  std::uint32_t slot_of(const CellKey& key, std::uint32_t guess = kNone) const;
  /// Marks `slot` as used in this tick.
  void touch(std::uint32_t slot) { slots_[slot].tick = tick_; }
  /// Allocates `chunks` chunks for `key`, which must be absent.
  /// @return its slot; kNone if this tick's cells fill the pool
  std::uint32_t insert(const CellKey& key, std::uint32_t chunks);

  std::uint32_t first_chunk(std::uint32_t slot) const { return slots_[slot].first_page * page_; }
  std::uint32_t slots() const { return static_cast<std::uint32_t>(slots_.size()); }
  std::uint32_t cells() const { return used_; }             ///< in the pool now
  std::uint64_t built() const { return built_; }            ///< number inserted since construction
  std::uint64_t evicted() const { return built_ - used_; }  ///< number of these that were removed

 private:
  struct Slot {
    CellKey key;
    std::uint32_t first_page = 0;
    std::uint32_t pages = 0;
    std::uint64_t tick = 0;  ///< last tick that used the slot
    bool used = false;
  };
  std::size_t bucket_of(const CellKey& key) const;
  void insert_key(std::uint32_t slot);
  void evict(std::uint32_t slot);
  std::uint32_t free_slot();
  std::uint32_t free_pages(std::uint32_t pages);

  std::uint32_t page_;
  std::vector<Slot> slots_;
  std::vector<std::uint32_t> table_;        ///< open addressing by key: slot or kNone
  std::vector<std::uint32_t> page_owners_;  ///< slot or kNone per page
  std::uint32_t next_page_ = 0;             ///< page at which the search for free pages resumes
  std::uint32_t clock_hand_ = 0;            ///< slot at which the search for a free slot resumes
  std::uint32_t used_ = 0;
  std::uint64_t built_ = 0;
  std::uint64_t tick_ = 1;
};

}  // namespace sf::raycast
