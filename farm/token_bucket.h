#pragma once
// A budget that renews itself.

#include <algorithm>
#include <cstdint>

namespace sf::farm {

/// A store that fills at a constant rate. Not thread-safe.
class TokenBucket {
 public:
  /// @param rate [unit/s] > 0 @param limit [unit] > 0; it is full at first, and never owes anything
  TokenBucket(double rate, double limit) : rate_(rate), limit_(limit), level_(limit) {}
  /// @param now [ns] does not decrease
  void refill(std::int64_t now) {
    level_ = std::min(limit_, level_ + rate_ * 1e-9 * static_cast<double>(now - last_));
    last_ = now;
  }
  bool has(double amount) const { return level_ >= amount; }
  /// Returns whether it can ever have that amount.
  bool may_have(double amount) const { return limit_ >= amount; }
  /// @param amount [unit] negative: gives back
  void spend(double amount) { level_ = std::clamp(level_ - amount, 0.0, limit_); }

 private:
  double rate_, limit_, level_;
  std::int64_t last_ = 0;
};

}  // namespace sf::farm
