#pragma once
// A budget that renews itself.

#include <algorithm>
#include <cstdint>

namespace sf::farm {

/// A store that fills at a constant rate. Not thread-safe.
class TokenBucket {
 public:
  /// @param rate [unit/s] > 0 @param limit [unit] > 0; it is full at first
  TokenBucket(double rate, double limit) : rate_(rate), limit_(limit), level_(limit) {}
  /// @param now [ns] does not decrease
  void refill(std::int64_t now) {
    level_ = std::min(limit_, level_ + rate_ * 1e-9 * static_cast<double>(now - last_));
    last_ = now;
  }
  bool has(double amount) const { return level_ >= amount; }
  /// Returns whether it can ever have that amount.
  bool may_have(double amount) const { return limit_ >= amount; }
  /// Spends an amount. If the bucket has less, it is empty afterwards, and the rest is forgotten.
  void spend(double amount) { level_ = std::clamp(level_ - amount, 0.0, limit_); }
  static constexpr double kMostCharged = 50.0;  ///< buckets
  /// Spends an amount that is known only now: what the bucket lacks is owed; beyond `most` the level becomes negative,
  /// at most by that of kMostCharged. @param amount [unit] negative: gives back
  /// @param most [unit] >= 0 that may be owed
  void charge(double amount, double most) {
    level_ = std::min(level_ - amount, limit_);
    const double more = std::clamp(-level_, 0.0, std::max(0.0, most - owed_));
    owed_ += more;
    level_ = std::max(level_ + more, -kMostCharged * limit_);
  }
  double limit() const { return limit_; }
  /// Pays the debt from the level, as far as it goes.
  void settle() {
    const double paid = std::clamp(level_, 0.0, owed_);
    owed_ -= paid;
    level_ -= paid;
  }

 private:
  double rate_, limit_, level_;
  double owed_ = 0.0;  ///< [unit] >= 0
  std::int64_t last_ = 0;
};

}  // namespace sf::farm
