#pragma once
// 95 % confidence intervals of means over seeds, and of proportions.

#include <cstddef>
#include <span>
#include <string_view>

namespace sf::scenarios {

/// A mean with its interval. NaN: none.
struct Interval {
  std::size_t count = 0;  ///< values that it is of
  double mean = 0.0, low = 0.0, high = 0.0;
};

/// The 0.975 quantile of Student's t distribution, to 10 digits up to 100 000 and to 3e-5 beyond. @param freedom
/// degrees of freedom >= 1
double student_quantile(std::size_t freedom);

/// mean ± t s / sqrt(n), Student's interval, of the finite values: NaN without any, no interval of a single one.
Interval mean_interval(std::span<const double> values);

/// The part `hits` of `count`, with Wilson's score interval (Wilson, "Probable inference, the law of succession, and
/// statistical inference", 1927); NaN for a count of 0.
Interval proportion_interval(std::size_t hits, std::size_t count);

/// Of a metric of runs: that of a proportion for `done`, which is 0 or 1, else that of a mean. Non-finite values are
/// left out.
Interval metric_interval(std::string_view name, std::span<const double> values);

}  // namespace sf::scenarios
