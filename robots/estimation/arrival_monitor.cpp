#include "robots/estimation/arrival_monitor.h"

#include <algorithm>
#include <cmath>

namespace sf::estimation {

void ArrivalMonitor::take(std::int64_t sent, std::int64_t arrival) {
  if (count_ > 0 && arrival - last_arrival_ < kSpacing) return;
  last_arrival_ = arrival;
  gaps_[count_++ % kStates] = arrival - sent;
  if (varies()) last_late_ = arrival;
}

std::int64_t ArrivalMonitor::least_gap() const {
  const auto end = gaps_.begin() + static_cast<std::ptrdiff_t>(std::min(count_, kStates));
  return count_ == 0 ? 0 : *std::min_element(gaps_.begin(), end);
}

std::int64_t ArrivalMonitor::spread() const {
  const auto end = gaps_.begin() + static_cast<std::ptrdiff_t>(std::min(count_, kStates));
  return count_ == 0 ? 0 : *std::max_element(gaps_.begin(), end) - least_gap();
}

/// Compares the means of the older and the newer half, which differ by 0.6 of the spread if gaps grow evenly. The least
/// and the greatest gap do not count, as a clock that is set, or one straggler, changes only one at first.
bool ArrivalMonitor::varies() const {
  if (count_ < kStates) return false;
  std::array<std::int64_t, kStates> sorted = gaps_;
  std::sort(sorted.begin(), sorted.end());
  const std::int64_t least = sorted[1], most = sorted[kStates - 2];
  double older = 0.0, newer = 0.0;  // [ns] sums of excess delays
  for (std::size_t k = 0; k < kStates; ++k)
    (k < kStates / 2 ? older : newer) +=
        static_cast<double>(std::clamp(gaps_[(count_ + k) % kStates], least, most) - least);
  const bool late = older + newer >= static_cast<double>(kStates) * static_cast<double>(kLate);
  const double trend = std::abs(newer - older) / static_cast<double>(kStates / 2);
  return late && trend < 0.25 * static_cast<double>(most - least);
}

}  // namespace sf::estimation
