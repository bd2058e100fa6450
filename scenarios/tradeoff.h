#pragma once
// Speed against accuracy, of one world on one device: every mode of every kind of sensor it has, measured.

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "gpu/device.h"
#include "world/world.h"

namespace sf::scenarios {

/// One mode of one kind. Errors are those of a reading's first column against the same reading in mode `exact`, without
/// noise; of `exact` itself against plain C++ for lasers (a sample of scans), else 0.
struct ModeResult {
  std::string sensor;  ///< the kind
  std::string mode;
  std::string what;   ///< the mode does
  std::string unit;   ///< of errors and bounds: m or T; empty: none
  double rate = 0.0;  ///< [1/s] elements (rays, fields, edges) of whole ticks in which only this kind is heard
  double tick = 0.0;  ///< [s] of such a tick, median
  // Of all elements, whether a bound covers them or not.
  double median = 0.0, p99 = 0.0;
  double max = 0.0;  ///< infinite: one of the two saw nothing
  // Of those that a stated bound covers: it is finite, they are numbers, and not flagged.
  double covered = 0.0;                                    ///< [-] their part of all
  double covered_max = 0.0;                                ///< their largest error
  double bound = std::numeric_limits<double>::infinity();  ///< the largest stated of them; infinite: none is covered
  bool front = false;  ///< no other mode of the kind is as fast and errs less, by `p99`
};

struct TradeoffOptions {
  std::uint64_t seed = 1;
  unsigned threads = 0;
  std::function<bool(double part)> progress;  ///< false: stop
};

/// @return modes of each kind that has some, `exact` first, in order of kinds; fewer when it was stopped
std::vector<ModeResult> tradeoff(const world::World& world, gpu::Device& device, const TradeoffOptions& options);

/// Columns sensor, mode, rate_per_s, covered, covered_max_error, covered_bound, all_median_error, all_p99_error,
/// all_max_error; metres or tesla. Where nothing is covered, its error and bound are empty.
std::string csv_of(const std::vector<ModeResult>& results);

enum class ErrorMeasure { median, p99, max };

/// What a user asks of all sensors.
struct AccuracyTarget {
  double metres = std::numeric_limits<double>::infinity();  ///< largest error of kinds that measure metres
  double tesla = std::numeric_limits<double>::infinity();   ///< likewise
  ErrorMeasure by = ErrorMeasure::max;
  double least_rate = 0.0;  ///< [Hz] of whole ticks; 0: not asked
};

/// Rows of `results`, one a kind: the fastest within the errors; or, where a rate is asked, the most accurate that
/// allow it together, and the fastest where none do.
std::vector<std::size_t> select_modes(const std::vector<ModeResult>& results, const AccuracyTarget& target);

/// The words of these modes, as `accuracy` and `--accuracy` take them.
std::string accuracy_words(const std::vector<ModeResult>& results, const std::vector<std::size_t>& rows);

}  // namespace sf::scenarios
