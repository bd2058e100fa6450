#pragma once
// Numbers about a control error, as the tables of the thesis have them.

#include <cstddef>
#include <span>

namespace sf::scenarios {

/// In the unit of the error. Not a number where there is nothing to say: no value, or one for the deviations.
struct ErrorStatistics {
  std::size_t count = 0;
  double mean = 0.0, deviation = 0.0, least = 0.0, most = 0.0;
  double abs_mean = 0.0, abs_deviation = 0.0, abs_least = 0.0, abs_most = 0.0;  ///< of the errors' absolute values
};

/// Deviations are those of a sample (count - 1). Values that are not finite are left out.
ErrorStatistics statistics_of(std::span<const double> errors);

/// The value that `part` in [0, 1] of all are not above (nearest rank); not a number where there is none.
double percentile(std::span<const double> values, double part);

}  // namespace sf::scenarios
