#pragma once
// Items by the sectors of directions in which they may be seen: what the device's lists are made of.

#include <cstdint>
#include <span>
#include <vector>

#include "raycast/records.h"

namespace sf::raycast {

/// Keeps its memory between uses.
class SectorLists {
 public:
  void clear() { items_.clear(); }
  /// Puts `item` into every sector within `half` of `bearing` [rad]; to all where `half` is beyond pi.
  void add(double bearing, double half, std::uint32_t item);
  /// To be called after the last `add`.
  void sort();
  /// Items of one sector, in the order in which they were added.
  std::span<const std::uint32_t> of(std::uint32_t sector) const {
    return std::span(order_).subspan(first_[sector], first_[sector + 1] - first_[sector]);
  }

 private:
  struct Item {
    std::uint32_t sector, item;
  };
  std::vector<Item> items_;
  std::vector<std::uint32_t> order_;
  std::uint32_t first_[SF_SECTORS + 1] = {};
};

}  // namespace sf::raycast
