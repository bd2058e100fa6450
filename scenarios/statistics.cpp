#include "scenarios/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace sf::scenarios {

namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

struct Four {
  double mean = kNothing, deviation = kNothing, least = kNothing, most = kNothing;
};

Four four_of(const std::vector<double>& values) {
  Four four;
  if (values.empty()) return four;
  const auto count = static_cast<double>(values.size());
  double sum = 0.0;
  for (const double v : values) sum += v;
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  four.mean = std::clamp(sum / count, *least, *most);  // exact for equal values, whose deviation is 0
  double squares = 0.0;
  for (const double v : values) squares += (v - four.mean) * (v - four.mean);
  if (values.size() > 1) four.deviation = std::sqrt(squares / (count - 1.0));
  four.least = *least;
  four.most = *most;
  return four;
}

}  // namespace

ErrorStatistics statistics_of(std::span<const double> errors) {
  std::vector<double> values, sizes;
  for (const double e : errors) {
    if (!std::isfinite(e)) continue;
    values.push_back(e);
    sizes.push_back(std::abs(e));
  }
  const Four plain = four_of(values);
  const Four size = four_of(sizes);
  return {values.size(), plain.mean,     plain.deviation, plain.least, plain.most,
          size.mean,     size.deviation, size.least,      size.most};
}

double percentile(std::span<const double> values, double part) {
  if (values.empty()) return kNothing;
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  const double rank = std::ceil(part * static_cast<double>(sorted.size()));
  return sorted[static_cast<std::size_t>(std::clamp(rank, 1.0, static_cast<double>(sorted.size()))) - 1];
}

}  // namespace sf::scenarios
