#include "raycast/sector_lists.h"

#include <algorithm>
#include <cmath>

namespace sf::raycast {

void SectorLists::add(double bearing, double half, std::uint32_t item) {
  const double per_radian = sectors_ / (2.0 * M_PI);
  const auto from = static_cast<std::int64_t>(std::floor((bearing - half) * per_radian));
  const auto to = static_cast<std::int64_t>(std::floor((bearing + half) * per_radian));
  const std::int64_t count = std::min<std::int64_t>(to - from + 1, sectors_);
  for (std::int64_t k = 0; k < count; ++k)
    items_.push_back({static_cast<std::uint32_t>(from + k) & (sectors_ - 1), item});
}

void SectorLists::sort() {
  first_.assign(sectors_ + 1, 0u);
  for (const Item& item : items_) ++first_[item.sector + 1];
  for (std::uint32_t s = 0; s < sectors_; ++s) first_[s + 1] += first_[s];
  order_.resize(items_.size());
  next_ = first_;
  for (const Item& item : items_) order_[next_[item.sector]++] = item.item;
}

}  // namespace sf::raycast
