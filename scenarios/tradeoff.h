#pragma once
// Speed and accuracy of all accuracy modes of a world's sensor types, measured on one device.

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "gpu/device.h"
#include "world/world.h"

namespace sf::scenarios {

/// Result of one mode. Errors compare a reading's first column with mode `exact`, without noise. For `exact` itself
/// they compare lasers with the plain C++ reference (a sample of scans), and are 0 for other sensors.
struct ModeResult {
  std::string sensor;  ///< sensor type
  std::string mode;
  std::string what;   ///< description of the mode
  std::string unit;   ///< of errors and bounds: m or T; empty: no unit
  double rate = 0.0;  ///< [1/s] elements (rays, fields, edges) in whole ticks with this sensor type alone
  double tick = 0.0;  ///< [s] median duration of such a tick
  // Errors of all elements, whether or not a bound covers them.
  double median = 0.0, p99 = 0.0;
  double max = 0.0;  ///< infinite: only one of the two readings is finite
  // Elements covered by a stated bound: the bound is finite, both values are numbers, and no quality flag is set.
  double covered = 0.0;      ///< [-] fraction of all elements
  double covered_max = 0.0;  ///< their largest error
  /// Their largest stated bound; infinite: no element is covered.
  double bound = std::numeric_limits<double>::infinity();
  bool front = false;  ///< Pareto-optimal: no other mode is both faster and more accurate (99th percentile)
};

/// Returns whether a mode changed no reading and only lost bounds, such as simplified meshes in a world without any. It
/// is never worth using.
inline bool is_pointless(const ModeResult& mode, const ModeResult& exact) {
  return mode.max <= exact.max && mode.covered < exact.covered;
}

struct TradeoffOptions {
  std::uint64_t seed = 1;
  unsigned threads = 0;
  std::function<bool(double part)> progress;  ///< called with the completed fraction; returns false to stop
};

/// @return the modes of each sensor type that has accuracy modes, `exact` first, in order of types; fewer if stopped
std::vector<ModeResult> tradeoff(const world::World& world, gpu::Device& device, const TradeoffOptions& options);

/// Returns columns sensor, mode, rate_per_s, covered, covered_max_error, covered_bound, all_median_error,
/// all_p99_error, all_max_error, in metres or tesla. Error and bound are empty if no element is covered.
std::string csv_of(const std::vector<ModeResult>& results);

enum class ErrorMeasure { median, p99, max };

/// Accuracy or rate requested by the user.
struct AccuracyTarget {
  double metres = std::numeric_limits<double>::infinity();  ///< maximum error of sensor types that measure metres
  double tesla = std::numeric_limits<double>::infinity();   ///< maximum error of sensor types that measure tesla
  ErrorMeasure by = ErrorMeasure::max;
  double least_rate = 0.0;  ///< [Hz] of whole ticks; 0: no requirement
};

/// Returns rows of `results`, one per sensor type: the fastest mode within the error limits. With a required rate: the
/// most accurate combination that reaches it, or the fastest one if none does.
std::vector<std::size_t> select_modes(const std::vector<ModeResult>& results, const AccuracyTarget& target);

/// Returns these modes in the syntax of the key `accuracy` and the option `--accuracy`.
std::string accuracy_words(const std::vector<ModeResult>& results, const std::vector<std::size_t>& rows);

}  // namespace sf::scenarios
