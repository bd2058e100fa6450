#pragma once
// What a piece of work costs: time on the clock, and time on all cores of this process.
//
// On a busy machine the clock counts what others did too; the cores' time does not.

#include <vector>

namespace sf::bench {

struct Cost {
  double wall_s = 0.0;  ///< [s]
  double cpu_s = 0.0;   ///< [s] user and system time of all threads
};

/// Since some fixed point in the past.
Cost now();

inline Cost operator-(const Cost& p, const Cost& q) { return {p.wall_s - q.wall_s, p.cpu_s - q.cpu_s}; }

/// Middle value; the mean of the two middle ones when their number is even. `values` must not be empty.
double median(std::vector<double> values);

/// Medians of both parts, taken apart.
Cost median(const std::vector<Cost>& costs);

/// [-] How many times as long `reference` took: medians over turns of its time / the other's, of both parts. As many
/// turns of each.
Cost ratio(const std::vector<Cost>& reference, const std::vector<Cost>& repeats);

}  // namespace sf::bench
