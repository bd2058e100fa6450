#pragma once
// Statistics of a control error, as in the tables of the thesis.

#include <cstddef>
#include <span>

namespace sf::scenarios {

/// In the unit of the error. NaN without values; deviations are NaN for a single value.
struct ErrorStatistics {
  std::size_t count = 0;
  double mean = 0.0, deviation = 0.0, least = 0.0, most = 0.0;
  double abs_mean = 0.0, abs_deviation = 0.0, abs_least = 0.0, abs_most = 0.0;  ///< of the absolute errors
};

/// Sample deviations (divisor count - 1). Ignores non-finite values.
ErrorStatistics statistics_of(std::span<const double> errors);

/// Returns the percentile by nearest rank, `part` in [0, 1]; NaN without values.
double percentile(std::span<const double> values, double part);

}  // namespace sf::scenarios
