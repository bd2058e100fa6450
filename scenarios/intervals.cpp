#include "scenarios/intervals.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "scenarios/statistics.h"

namespace sf::scenarios {

namespace {

constexpr double kConfidence = 0.95;
constexpr double kNormalQuantile = 1.959963984540054;  // 0.975 quantile of the standard normal distribution
constexpr std::size_t kMostSummed = 100'000;           // beyond this, the normal distribution is within 3e-5

/// P(|t| < tan(angle) sqrt(freedom)): finite sums of Abramowitz and Stegun, "Handbook of Mathematical Functions",
/// 26.7.3 and 26.7.4.
double central_part(double angle, std::size_t freedom) {
  const double cosine = base::cos(angle), square = cosine * cosine;
  const bool odd = freedom % 2 == 1;
  double term = odd ? cosine : 1.0, sum = freedom > 1 ? term : 0.0;
  for (std::size_t k = odd ? 3 : 2; k + 2 <= freedom; k += 2) {
    const auto n = static_cast<double>(k);
    term *= square * (n - 1.0) / n;
    sum += term;
  }
  return odd ? 2.0 / M_PI * (angle + base::sin(angle) * sum) : base::sin(angle) * sum;
}

}  // namespace

double student_quantile(std::size_t freedom) {
  if (freedom > kMostSummed) return kNormalQuantile;
  double low = 0.0, high = 0.5 * M_PI;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (central_part(middle, freedom) < kConfidence ? low : high) = middle;
  }
  return base::tan(0.5 * (low + high)) * std::sqrt(static_cast<double>(freedom));
}

Interval mean_interval(std::span<const double> values) {
  const ErrorStatistics s = statistics_of(values);
  if (s.count < 2) return {s.count, s.mean, NAN, NAN};
  const double half = student_quantile(s.count - 1) * s.deviation / std::sqrt(static_cast<double>(s.count));
  return {s.count, s.mean, s.mean - half, s.mean + half};
}

Interval proportion_interval(std::size_t hits, std::size_t count) {
  if (count == 0) return {0, NAN, NAN, NAN};
  const double n = static_cast<double>(count), p = static_cast<double>(hits) / n;
  const double z2 = kNormalQuantile * kNormalQuantile;
  const double middle = (p + 0.5 * z2 / n) / (1.0 + z2 / n);
  const double half = kNormalQuantile / (1.0 + z2 / n) * std::sqrt(p * (1.0 - p) / n + 0.25 * z2 / (n * n));
  // Rounding must not move the exact limits of 0 and 1.
  return {count, p, hits == 0 ? 0.0 : std::max(0.0, middle - half), hits == count ? 1.0 : std::min(1.0, middle + half)};
}

Interval metric_interval(std::string_view name, std::span<const double> values) {
  if (name != "done") return mean_interval(values);
  const auto finite = std::count_if(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
  const auto hits = std::count(values.begin(), values.end(), 1.0);
  return proportion_interval(static_cast<std::size_t>(hits), static_cast<std::size_t>(finite));
}

}  // namespace sf::scenarios
