#pragma once
// Cost of a computation: wall time, and CPU time on all cores of this process. On a busy machine, wall time includes
// delays caused by other processes; CPU time does not.

#include <algorithm>
#include <string>
#include <vector>

namespace sf::bench {

struct Cost {
  double wall_s = 0.0;  ///< [s]
  double cpu_s = 0.0;   ///< [s] user and system time of all threads
};

/// Time since a fixed point in the past.
Cost now();

/// Returns the cost since `start`. First sleeps for a millisecond, which is not counted: a thread's time is updated
/// when it sleeps, and pool threads spin for a while before that.
Cost since(const Cost& start);

inline Cost operator-(const Cost& p, const Cost& q) { return {p.wall_s - q.wall_s, p.cpu_s - q.cpu_s}; }

/// Median; the mean of the two middle values for an even count. @pre `values` is not empty
double median(std::vector<double> values);

/// Medians of both parts, computed separately.
Cost median(const std::vector<Cost>& costs);

/// [-] Medians over turns of the reference's cost divided by the other's, separately for both parts. @pre equal numbers
/// of turns
Cost ratio(const std::vector<Cost>& reference, const std::vector<Cost>& repeats);

/// One method of a comparison.
struct Timing {
  std::string method;
  std::vector<Cost> repeats;  ///< one per turn
  Cost typical;               ///< medians of `repeats`
  double ratio = 0.0;         ///< [-] median over turns of reference time / own time; 0 without a reference
  double cpu_ratio = 0.0;     ///< [-] the same for CPU time on all cores
};

/// Sets the ratios relative to the method called `reference`; does nothing if there is none.
template <class Result>
void set_ratios(std::vector<Result>& results, const std::string& reference) {
  const auto known =
      std::find_if(results.begin(), results.end(), [&](const Result& result) { return result.method == reference; });
  if (known == results.end()) return;
  for (Result& result : results) {
    const Cost times = ratio(known->repeats, result.repeats);
    result.ratio = times.wall_s;
    result.cpu_ratio = times.cpu_s;
  }
}

/// Runs each method once in every turn, in rotating order, so that changes in machine load affect all of them equally.
/// `run(k, turn)` runs method k and returns its cost. Sets the medians, and the ratios relative to the method called
/// `reference`.
template <class Result, class Run>
void take_turns(std::vector<Result>& results, std::size_t turns, const std::string& reference, Run&& run) {
  for (std::size_t turn = 0; turn < turns; ++turn)
    for (std::size_t i = 0; i < results.size(); ++i) {
      const std::size_t k = (turn + i) % results.size();
      results[k].repeats.push_back(run(k, turn));
    }
  for (Result& result : results) result.typical = median(result.repeats);
  set_ratios(results, reference);
}

}  // namespace sf::bench
