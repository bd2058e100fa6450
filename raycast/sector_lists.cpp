#include "raycast/sector_lists.h"

#include <algorithm>
#include <cmath>

namespace sf::raycast {

void SectorLists::add(double bearing, double half, std::uint32_t item) {
  constexpr double kPerRadian = SF_SECTORS / (2.0 * M_PI);
  const auto from = static_cast<std::int64_t>(std::floor((bearing - half) * kPerRadian));
  const auto to = static_cast<std::int64_t>(std::floor((bearing + half) * kPerRadian));
  const std::int64_t count = std::min<std::int64_t>(to - from + 1, SF_SECTORS);
  for (std::int64_t k = 0; k < count; ++k)
    items_.push_back({static_cast<std::uint32_t>(from + k) & (SF_SECTORS - 1), item});
}

void SectorLists::sort() {
  std::fill(std::begin(first_), std::end(first_), 0u);
  for (const Item& item : items_) ++first_[item.sector + 1];
  for (std::uint32_t s = 0; s < SF_SECTORS; ++s) first_[s + 1] += first_[s];
  order_.resize(items_.size());
  std::uint32_t next[SF_SECTORS];
  std::copy(first_, first_ + SF_SECTORS, next);
  for (const Item& item : items_) order_[next[item.sector]++] = item.item;
}

}  // namespace sf::raycast
