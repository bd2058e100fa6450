#include "sensors/allan.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace sf::sensors {

std::vector<AllanPoint> allan_deviation(std::span<const double> samples, double interval) {
  const std::size_t count = samples.size();
  // Sums of deviations from the mean stay small.
  const double mean = std::accumulate(samples.begin(), samples.end(), 0.0) / static_cast<double>(count);
  std::vector<double> sums{0.0};
  for (const double sample : samples) sums.push_back(sums.back() + (sample - mean));

  constexpr double kStep = 1.2589254117941673;  // 10^(1/10)
  std::vector<AllanPoint> points;
  for (std::size_t m = 1; 4 * m <= count;
       m = std::max(m + 1, static_cast<std::size_t>(std::round(static_cast<double>(m) * kStep)))) {
    double squares = 0.0;
    for (std::size_t i = 0; i + 2 * m <= count; ++i) {
      const double change = sums[i + 2 * m] - 2.0 * sums[i + m] + sums[i];
      squares += change * change;
    }
    const double length = static_cast<double>(m), terms = static_cast<double>(count - 2 * m + 1);
    points.push_back({length * interval, std::sqrt(squares / (2.0 * terms)) / length});
  }
  return points;
}

}  // namespace sf::sensors
