#include "scenarios/sweep_sample.h"

#include <algorithm>
#include <random>
#include <utility>

namespace sf::scenarios {

namespace {

// The standard defines the numbers of the engine, but not those of its distributions and of std::shuffle.
using Engine = std::mt19937_64;

/// Returns a number in [0, 1) with 53 random bits.
double uniform(Engine& engine) { return 0x1p-53 * static_cast<double>(engine() >> 11); }

}  // namespace

std::vector<std::vector<double>> sample_points(SampleMethod method, std::uint64_t points, std::size_t dimensions,
                                               std::uint64_t seed) {
  Engine engine(seed);
  std::vector<std::vector<double>> rows(points, std::vector<double>(dimensions));
  for (std::vector<double>& row : rows)
    for (double& x : row) x = uniform(engine);
  if (method == SampleMethod::random) return rows;
  std::vector<std::uint64_t> interval(points);
  for (std::size_t d = 0; d < dimensions; ++d) {
    for (std::uint64_t i = 0; i < points; ++i) interval[i] = i;
    for (std::uint64_t i = points; i > 1; --i)
      std::swap(interval[i - 1], interval[static_cast<std::uint64_t>(uniform(engine) * static_cast<double>(i))]);
    // The sum may round up to the next interval's first number.
    for (std::uint64_t i = 0; i < points; ++i)
      rows[i][d] =
          std::min((static_cast<double>(interval[i]) + rows[i][d]) / static_cast<double>(points), 1.0 - 0x1p-53);
  }
  return rows;
}

}  // namespace sf::scenarios
