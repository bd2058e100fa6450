#pragma once
// Errors of an accuracy mode: differences between readings and those of a more accurate mode, and the bounds that cover
// them.

#include <cstdint>
#include <limits>
#include <vector>

#include "base/reading.h"

namespace sf::scenarios {

/// [unit of the first column] Returns the bound that a reading states for its first column's `value` in row `element`;
/// infinite: no bound, because the element is flagged or the value is NaN.
double covering_bound(const base::ReadingBlock& reading, std::size_t element, double value);

/// Memory is bounded: beyond 4 million errors, quantiles use every k-th error, where k is a power of two.
class ErrorDistribution {
 public:
  /// Two NaN differ by 0. A number differs from NaN or infinity by infinity.
  /// @param bound that covers `ours`; infinite: none
  void add(double ours, double theirs, double bound);

  std::uint64_t count() const { return count_; }
  double zero() const { return share(zero_); }  ///< [-] fraction of all errors that are 0
  /// Returns the error at the fraction `part` in [0, 1] of their ascending order; 0 without errors.
  double quantile(double part) const;
  double max() const { return max_; }                 ///< infinite if only one of two values is finite
  double covered() const { return share(covered_); }  ///< [-] fraction of all elements covered by a bound
  double covered_max() const { return covered_max_; }
  /// Returns the largest bound; infinite if no element is covered.
  double bound() const { return covered_ > 0 ? bound_ : std::numeric_limits<double>::infinity(); }

 private:
  double share(std::uint64_t part) const {
    return count_ > 0 ? static_cast<double>(part) / static_cast<double>(count_) : 0.0;
  }

  std::vector<double> kept_;
  std::uint64_t stride_ = 1;  ///< every `stride_`-th error is stored
  std::uint64_t count_ = 0, zero_ = 0, covered_ = 0;
  double max_ = 0.0, covered_max_ = 0.0, bound_ = 0.0;
};

}  // namespace sf::scenarios
