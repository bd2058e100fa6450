#pragma once
// Cells of a tick's views: where each of them looks from, and which cells have no lists yet. For both casters.

#include <cstdint>
#include <span>
#include <vector>

#include "base/thread_pool.h"
#include "raycast/cell_cache.h"
#include "raycast/list_configs.h"
#include "raycast/viewpoint.h"

namespace sf::raycast {

/// One thread, but for what is const. `configs` must outlive it.
class ViewCells {
 public:
  /// @param size [m] of the side of a cell, by range and beams of its family
  ViewCells(const ListConfigs& configs, double (*size)(double range, std::uint32_t beams), CellCache cache);

  /// Finds the cell of each of `views`, keeps what the pool has of them for this tick, and names the others.
  void find(std::span<const Viewpoint> views, base::ThreadPool& thread_pool);
  /// Leaves out of `missing` what the pool has by now.
  void drop_cached();
  /// More room in the pool; never less.
  void grow(std::uint32_t slots, std::uint32_t chunks);

  const CellKey& key(std::size_t view) const { return keys_[view]; }
  /// Of the view's cell in the pool, or CellPool::kNone.
  std::uint32_t slot(std::size_t view) const {
    return slots_[view] != CellCache::kNone ? slots_[view] : cache_.slot_of(keys_[view]);
  }
  /// The last `find`'s cells without lists, each once, in one order.
  const std::vector<CellKey>& missing() const { return missing_; }
  CellCache& cache() { return cache_; }
  const CellCache& cache() const { return cache_; }

  double size_of(std::size_t config) const { return sizes_[config]; }  ///< [m]
  glm::dvec2 centre_of(const CellKey& key) const;                      ///< [m]
  static std::size_t config_of(const CellKey& key) { return static_cast<std::size_t>(key.config / 2); }
  /// Whether viewpoints in the cell lie inside of solids.
  static bool in_solid(const CellKey& key) { return key.config % 2 == 1; }
  /// Notes of a new cell whether all of it is inside of solids, or all of it outside. @param nearby walls round it
  void classify_cell(const CellKey& key, std::uint32_t slot, const WallIndex::Query& query);

 private:
  CellKey key_of(const Viewpoint& view) const;

  const ListConfigs& configs_;
  std::vector<double> sizes_;
  CellCache cache_;
  std::vector<std::uint8_t> one_sided_;  ///< per slot: on one side as a whole
  std::vector<CellKey> keys_;            ///< of this tick's views
  std::vector<std::uint32_t> slots_;     ///< of this tick's views, where the pool had them already
  std::vector<CellKey> missing_;
};

}  // namespace sf::raycast
