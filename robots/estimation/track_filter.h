#pragma once
// The filter of one object: takes measurements in any order of arrival and predicts the state at any time.
//
//   TrackFilter filter({.model = differential_drive()});
//   filter.take(measurement, now);                 // may be late
//   const Prediction seen = filter.predict(now);   // seen.status, seen.age, seen.estimate
//
// Late measurements are inserted at their place in a MeasurementWindow. All verdicts except `future`, `too_late`,
// `replayed` and `invalid` are made in this order, so measurements that arrive within the window give bitwise identical
// results in any order of arrival.
//
// Measurements may have any subset of the components. While they leave the heading open, as positions alone do, the
// filter keeps several heading hypotheses.

#include <array>
#include <cstdint>
#include <vector>

#include "base/state_quality.h"
#include "robots/estimation/hypotheses.h"
#include "robots/estimation/measurement_window.h"
#include "robots/estimation/state.h"

namespace sf::estimation {

/// How the owner of the filter treats an object whose state is stale.
enum class StalePolicy : std::uint8_t {
  freeze,  ///< keeps it at rest at its last prediction that was not stale
  hide,    ///< hides it from the world until it is measured again
  drop     ///< hides it and drops its track and its sender's clock
};

struct FilterOptions {
  MotionModel model;
  /// Probability that the gate rejects a correct measurement, in (0, 1).
  double gate = 1e-4;
  double max_jump = 10.0;                    ///< [m] > 0 from the prediction; measurements farther away are a `jump`
  std::int64_t stale_after = 1'000'000'000;  ///< [ns] > 0 without a used measurement
  std::int64_t window = 1'000'000'000;       ///< [ns] > 0; measurements older than the newest by more are rejected
  std::size_t capacity = 64;                 ///< > 0 measurements in the window; when full, the window becomes shorter
  std::int64_t max_future = 20'000'000;      ///< [ns] >= 0 by which a measurement may be ahead of the clock
  /// > 0 Largest number of Gaussians for a state with an uncertain heading. With 1, the covariance is that of a
  /// linearised path, which is too small if the heading is not measured for a second or longer.
  std::size_t hypotheses = 64;
};

struct Prediction {
  enum class Status : std::uint8_t {
    none,   ///< no measurement was used since construction or `reset`; the other members are 0
    fresh,  ///< age <= stale_after
    stale   ///< at rest, at the predicted pose of the moment when the state became stale
  };
  Status status = Status::none;
  std::int64_t age = 0;  ///< [ns] since the last used measurement; < 0 for earlier times
  /// Estimate at the requested time, from the most probable hypothesis. Its covariance is that of all hypotheses about
  /// it. When stale, the errors about the pose at rest include the distance and speeds since then, so the covariance
  /// grows with age. An unknown heading has a variance of at least pi^2 / 3.
  Estimate estimate;
};

/// Returns the age and the covariance of a prediction, as readings, V2V and TAG state them.
base::StateQuality quality_of(const Prediction& prediction);

/// Limits of the squared innovation, by degrees of freedom from 1 on.
using GateLimits = std::array<double, kComponents + 1>;
/// @param gate as in FilterOptions
GateLimits gate_limits(double gate);

/// Allocates in the constructor, and once per place in the window when an uncertain heading takes a second hypothesis
/// or more. Not thread-safe.
class TrackFilter {
 public:
  explicit TrackFilter(const FilterOptions& options) : TrackFilter(options, gate_limits(options.gate)) {}
  /// @param limits gate_limits(options.gate), computed once for several filters
  TrackFilter(const FilterOptions& options, const GateLimits& limits);

  /// @param now [ns] on the clock that the measurements use
  /// @return the verdict on the measurement at its place in the window
  Verdict take(const Measurement& measurement, std::int64_t now);

  /// Returns the state at `time`, from the measurements up to that time. A time before the window is extrapolated
  /// backwards from the first estimate in it.
  Prediction predict(std::int64_t time) const;

  /// Drops everything except the counts, for a sender that restarts.
  void reset();

  const VerdictCounts& counts() const { return window_.counts(); }

 private:
  struct State {
    State() { hypotheses.reserve(1); }

    std::int64_t last_position = 0;  ///< [ns] time of the last used measurement with a position
    Hypotheses hypotheses;           ///< at the last used measurement

    bool known() const { return !hypotheses.empty(); }
    std::int64_t time() const { return hypotheses[0].estimate.time; }
  };

  Verdict apply(const Measurement& measurement, State& state);
  void advance_to(std::int64_t time, const State& newest) const;

  FilterOptions options_;
  GateLimits limits_;
  MeasurementWindow<Measurement, State> window_;

  // Members, to avoid reallocation. `ahead_`: a whole step after the state at `ahead_of_`; empty after each
  // measurement.
  mutable Hypotheses predicted_;
  mutable Hypotheses ahead_;
  mutable const State* ahead_of_ = nullptr;
};

}  // namespace sf::estimation
