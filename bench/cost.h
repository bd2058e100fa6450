#pragma once
// Cost of a computation: wall time, and CPU time on all cores of this process. On a busy machine wall time includes
// delays by other processes; CPU time does not.

#include <vector>

namespace sf::bench {

struct Cost {
  double wall_s = 0.0;  ///< [s]
  double cpu_s = 0.0;   ///< [s] user and system time of all threads
};

/// Time since a fixed point in the past.
Cost now();

inline Cost operator-(const Cost& p, const Cost& q) { return {p.wall_s - q.wall_s, p.cpu_s - q.cpu_s}; }

/// Median; the mean of the two middle values for an even count. @pre `values` is not empty
double median(std::vector<double> values);

/// Medians of both parts, computed separately.
Cost median(const std::vector<Cost>& costs);

/// [-] Medians over turns of the reference's cost divided by the other's, separately for both parts. @pre equal numbers
/// of turns
Cost ratio(const std::vector<Cost>& reference, const std::vector<Cost>& repeats);

}  // namespace sf::bench
