#pragma once
// Cells of a tick's views, and the cells whose lists are missing. Used by the casters on the host and on the device.

#include <cstdint>
#include <span>
#include <vector>

#include "base/thread_pool.h"
#include "raycast/cell_cache.h"
#include "raycast/list_configs.h"
#include "raycast/viewpoint.h"

namespace sf::raycast {

/// Returns the side of a cell [m]: an eighth of the range for a scanner with several hundred beams, more for fewer
/// beams, and at least min(0.25 m, range). For moving robots, smaller cells cost more to build than they save.
double coarse_cell_size(double range, std::uint32_t beams);

/// Const functions are thread-safe, the others are not. `configs` must outlive this object.
class ViewCells {
 public:
  /// @param size returns the side of a cell [m] for the range [m] and beams of its list config
  ViewCells(const ListConfigs& configs, double (*size)(double range, std::uint32_t beams), CellCache cache);

  /// Finds the cell of each view, marks cached cells as used in this tick, and lists the missing ones.
  void find(std::span<const Viewpoint> views, base::ThreadPool& thread_pool);
  /// Removes cells that have been cached since `find` from `missing`.
  void drop_cached();
  /// Enlarges the cache, never shrinks it.
  void grow(std::uint32_t slots, std::uint32_t chunks);

  const CellKey& key(std::size_t view) const { return keys_[view]; }
  /// Returns the slot of the view's cell, or CellCache::kNone.
  std::uint32_t slot(std::size_t view) const {
    return slots_[view] != CellCache::kNone ? slots_[view] : cache_.slot_of(keys_[view]);
  }
  /// Returns the cells that had no lists in the last `find`, without duplicates, in deterministic order.
  const std::vector<CellKey>& missing() const { return missing_; }
  CellCache& cache() { return cache_; }
  const CellCache& cache() const { return cache_; }

  double size_of(std::size_t config) const { return sizes_[config]; }  ///< [m]
  glm::dvec2 centre_of(const CellKey& key) const;                      ///< [m]
  static std::size_t config_of(const CellKey& key) { return static_cast<std::size_t>(key.config / 2); }
  /// Returns whether viewpoints in the cell are inside solids.
  static bool in_solid(const CellKey& key) { return key.config % 2 == 1; }
  /// Finds the parts of a new cell that no surface touches. @param near indices of the walls around it
  void find_clear_parts(const CellKey& key, std::uint32_t slot, std::span<const std::uint32_t> near);

 private:
  /// Bit masks over the 8 x 8 parts of a cell: which of them are known to be on the side of all surfaces (inside or
  /// outside) that the cell's key states.
  struct Parts {
    std::uint64_t clear = 0;  ///< parts that no surface touches
    std::uint64_t known = 0;  ///< of these, parts that are connected with a viewpoint of the cell
  };
  CellKey key_of(const Viewpoint& view, std::uint32_t last_slot) const;
  std::uint32_t part_of(const Viewpoint& view) const;
  void learn_side(const Viewpoint& view, Parts& parts) const;

  const ListConfigs& configs_;
  std::vector<double> sizes_;
  CellCache cache_;
  std::vector<Parts> parts_;          ///< per slot
  std::vector<CellKey> keys_;         ///< of this tick's views
  std::vector<std::uint32_t> slots_;  ///< of this tick's views; kNone if the cell was missing
  std::vector<CellKey> missing_;
};

}  // namespace sf::raycast
