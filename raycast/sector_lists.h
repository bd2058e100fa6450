#pragma once
// Lists of items by the sectors of directions in which they may be visible.

#include <cstdint>
#include <span>
#include <vector>

#include "raycast/records.h"

namespace sf::raycast {

/// Reuses its memory.
class SectorLists {
 public:
  /// Removes all items. @param sectors a power of two; sector 0 begins at bearing 0
  void clear(std::uint32_t sectors = SF_SECTORS) { items_.clear(), sectors_ = sectors; }
  /// Adds `item` to every sector within `half` of `bearing` [rad]; to all sectors if `half` > pi.
  void add(double bearing, double half, std::uint32_t item);
  /// Builds the lists. Call after the last `add`.
  void sort();
  /// Returns the items of one sector, in the order of `add`.
  std::span<const std::uint32_t> of(std::uint32_t sector) const {
    return std::span(order_).subspan(first_[sector], first_[sector + 1] - first_[sector]);
  }

 private:
  struct Item {
    std::uint32_t sector, item;
  };
  std::vector<Item> items_;
  std::vector<std::uint32_t> order_;
  std::uint32_t sectors_ = SF_SECTORS;
  std::vector<std::uint32_t> first_ =
      std::vector<std::uint32_t>(SF_SECTORS + 1);  ///< of each sector in `order_`, and the end
  std::vector<std::uint32_t> next_;                ///< scratch
};

}  // namespace sf::raycast
