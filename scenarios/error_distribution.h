#pragma once
// Errors of an accuracy mode: differences between elements of readings and those of a better one, and the bounds that
// cover them.

#include <cstdint>
#include <limits>
#include <vector>

#include "base/reading.h"

namespace sf::scenarios {

/// [unit of the first column] The bound that a reading states for its first column's `value` in row `element`;
/// infinite: none, since the element is flagged or the value is NaN.
double covering_bound(const base::ReadingBlock& reading, std::size_t element, double value);

/// Bounded memory: quantiles of more than 4 million errors are those of every k-th, k a power of two.
class ErrorDistribution {
 public:
  /// Two NaN differ by 0; a number differs from NaN or infinity by infinity.
  /// @param bound that covers `ours`; infinite: none
  void add(double ours, double theirs, double bound);

  std::uint64_t count() const { return count_; }
  double zero() const { return share(zero_); }  ///< [-] part of all errors that are 0
  /// The error at the fraction `part` in [0, 1] of their ascending order; 0 without errors.
  double quantile(double part) const;
  double max() const { return max_; }                 ///< infinite: only one of two values is a finite number
  double covered() const { return share(covered_); }  ///< [-] part of all elements that a bound covers
  double covered_max() const { return covered_max_; }
  /// The largest bound; infinite: none covers an element.
  double bound() const { return covered_ > 0 ? bound_ : std::numeric_limits<double>::infinity(); }

 private:
  double share(std::uint64_t part) const {
    return count_ > 0 ? static_cast<double>(part) / static_cast<double>(count_) : 0.0;
  }

  std::vector<double> kept_;
  std::uint64_t stride_ = 1;  ///< every `stride_`-th error is kept
  std::uint64_t count_ = 0, zero_ = 0, covered_ = 0;
  double max_ = 0.0, covered_max_ = 0.0, bound_ = 0.0;
};

}  // namespace sf::scenarios
