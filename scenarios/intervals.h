#pragma once
// 95 % confidence intervals of means over seeds, and of proportions.

#include <cstddef>
#include <span>
#include <string_view>

namespace sf::scenarios {

/// A mean with its interval. NaN: undefined.
struct Interval {
  std::size_t count = 0;  ///< number of values
  double mean = 0.0, low = 0.0, high = 0.0;
};

/// Returns the 0.975 quantile of Student's t distribution, to 10 digits up to 100 000 degrees of freedom, and to 3e-5
/// beyond.
/// @param freedom degrees of freedom >= 1
double student_quantile(std::size_t freedom);

/// Returns Student's interval, mean ± t s / sqrt(n), of the finite values. NaN without values; a single value has no
/// interval.
Interval mean_interval(std::span<const double> values);

/// Returns the fraction `hits` of `count` with Wilson's score interval (Wilson, "Probable inference, the law of
/// succession, and statistical inference", 1927); NaN for a count of 0.
Interval proportion_interval(std::size_t hits, std::size_t count);

/// Returns the interval of a metric of runs: of a proportion for `done`, which is 0 or 1, else of a mean. Ignores
/// non-finite values.
Interval metric_interval(std::string_view name, std::span<const double> values);

}  // namespace sf::scenarios
