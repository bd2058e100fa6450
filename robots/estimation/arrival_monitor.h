#pragma once
// Detects senders whose states arrive late by changing amounts, from timestamps and times of arrival.
//
// A gap is an arrival minus its timestamp: the offset of both clocks plus the delay. Delays that vary make gaps vary in
// both directions. Constant delays and offsets do not count, since one-way packets do not reveal them. Gaps that only
// grow or fall are no delays: such timestamps are zero, count something else or run at another pace.

#include <array>
#include <cstdint>
#include <optional>

namespace sf::estimation {

/// Uses bounded memory. Reads no clock. Not thread-safe.
class ArrivalMonitor {
 public:
  static constexpr std::size_t kStates = 12;                      ///< number of compared gaps
  static constexpr std::int64_t kSpacing = 50'000'000;            ///< [ns] least time between two of their arrivals
  static constexpr std::int64_t kLate = 30'000'000;               ///< [ns] mean excess over the least gap when late
  static constexpr std::int64_t kHoldAfterLate = 10'000'000'000;  ///< [ns] for which `is_late` holds

  /// Adds a state stamped `sent` on the sender's clock that arrived at `arrival`, both in [0, 2^62] ns.
  void take(std::int64_t sent, std::int64_t arrival);

  /// Returns whether states were late at `arrival` or in the kHoldAfterLate before it.
  bool is_late(std::int64_t arrival) const { return last_late_ && arrival - *last_late_ <= kHoldAfterLate; }
  std::int64_t least_gap() const;  ///< [ns] of the compared states; 0 before the first
  std::int64_t spread() const;     ///< [ns] of the compared gaps

  void reset() { *this = {}; }

 private:
  bool varies() const;

  std::array<std::int64_t, kStates> gaps_{};  ///< [ns] ring; the next one replaces `gaps_[count_ % kStates]`
  std::size_t count_ = 0;
  std::int64_t last_arrival_ = 0;
  std::optional<std::int64_t> last_late_;
};

}  // namespace sf::estimation
