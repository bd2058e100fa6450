#pragma once
// The filter of one object: measurements in any order of arrival, estimates for any time.
//
//   TrackFilter filter({.model = differential_drive()});
//   filter.take(measurement, now);                 // late ones too
//   const Prediction seen = filter.predict(now);   // seen.status, seen.age, seen.estimate
//
// The filter keeps the measurements of the last `window`, sorted, each with the estimate after it. A late measurement
// is inserted at its place and the later ones are applied again. All decisions except `future`, `too_late`, `replayed`
// and `invalid` are made in that order: measurements that arrive within the window give the same bytes in any order of
// arrival.
//
// Measurements may have any of the components. Where they leave the heading open, as positions alone do, the filter
// keeps several hypotheses of it.

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "robots/estimation/hypotheses.h"
#include "robots/estimation/state.h"

namespace sf::estimation {

/// Treatment of an object whose state is stale, by the owner of the filter.
enum class StalePolicy : std::uint8_t {
  freeze,  ///< stands at its last prediction that was not stale
  hide,    ///< is out of the world until it is measured again
  drop     ///< likewise, and its track and its sender's clock are forgotten
};

struct FilterOptions {
  MotionModel model;
  /// Probability with which the gate refuses a true measurement, in (0, 1).
  double gate = 1e-4;
  double max_jump = 10.0;                    ///< [m] > 0 from the prediction; a farther measurement is a `jump`
  std::int64_t stale_after = 1'000'000'000;  ///< [ns] > 0 without a used measurement
  std::int64_t window = 1'000'000'000;       ///< [ns] > 0; measurements older than the newest by more are refused
  std::size_t capacity = 64;                 ///< > 0 measurements in the window; with more, the window is shorter
  std::int64_t max_future = 20'000'000;      ///< [ns] >= 0 that a measurement may lie ahead of the clock
  /// > 0 Gaussians that a state with an uncertain heading may have. With 1, the covariance is that of a linearised
  /// path: too small when the heading is not measured for a second, or never.
  std::size_t hypotheses = 64;
};

/// Result of a measurement.
enum class Verdict : std::uint8_t {
  started,   ///< used: the first one with a position, the first after a stale time, or one
             ///< beyond the gate when no position was used for that time
  used,      ///< updated the estimate
  outlier,   ///< refused by the gate
  jump,      ///< refused: farther from the prediction than `max_jump`
  no_track,  ///< refused: without a position, of an object without a state
  replayed,  ///< refused: identical to one in the window or the newest that left it
  too_late,  ///< refused: before the window
  future,    ///< refused: ahead of the clock
  invalid    ///< refused: `is_valid` is false
};
inline constexpr std::size_t kVerdicts = 9;
std::string_view name(Verdict verdict);

/// Number of measurements by verdict. A late measurement may change the verdicts of later ones; each counts once.
using VerdictCounts = std::array<std::uint64_t, kVerdicts>;

struct Prediction {
  enum class Status : std::uint8_t {
    none,   ///< nothing was used yet, or since `reset`; the other members are 0
    fresh,  ///< age <= stale_after
    stale   ///< the pose is that of the time when the state became stale, at rest
  };
  Status status = Status::none;
  std::int64_t age = 0;  ///< [ns] since the last used measurement; < 0 for times before it
  /// At the time asked for, from the most probable hypothesis. Its covariance is that of all hypotheses around it.
  /// Stale: around the pose at rest, so that it has the way and the speeds since then as errors, and grows with age. An
  /// unknown heading has a variance of pi^2 / 3 and more.
  Estimate estimate;
};

/// Of the squared innovation, by degrees of freedom from 1 on.
using GateLimits = std::array<double, kComponents + 1>;
/// @param gate as in FilterOptions
GateLimits gate_limits(double gate);

/// Allocates in the constructor alone, except for the second and further hypotheses of uncertain headings, once for
/// each place in the window. One thread.
class TrackFilter {
 public:
  explicit TrackFilter(const FilterOptions& options) : TrackFilter(options, gate_limits(options.gate)) {}
  /// @param limits of `options.gate`, computed once for several filters
  TrackFilter(const FilterOptions& options, const GateLimits& limits);

  /// @param now [ns] on the clock of the measurements' times
  /// @return the measurement's verdict at its place in the window
  Verdict take(const Measurement& measurement, std::int64_t now);

  /// State at `time`, from the measurements up to then. Before the window: backwards from the estimate at its begin.
  Prediction predict(std::int64_t time) const;

  /// Forgets everything but the counts, as for a sender that restarts.
  void reset();

  const VerdictCounts& counts() const { return counts_; }

 private:
  struct State {
    std::int64_t last_position = 0;  ///< [ns] of the last used one with a position
    Hypotheses hypotheses;           ///< at the last used measurement

    bool known() const { return !hypotheses.empty(); }
    std::int64_t time() const { return hypotheses[0].estimate.time; }
  };
  struct Entry {
    Measurement measurement;
    Verdict verdict = Verdict::used;
    State after;
  };

  Entry& entry(std::size_t k) { return entries_[(first_ + k) % entries_.size()]; }
  const Entry& entry(std::size_t k) const { return entries_[(first_ + k) % entries_.size()]; }
  void drop_oldest();
  void drop_before(std::int64_t time);
  std::size_t insert(const Measurement& measurement);
  void replay(std::size_t from);
  Verdict apply(const Measurement& measurement, State& state);
  void advance_to(std::int64_t time, const State& newest, std::size_t place) const;
  Verdict count(Verdict verdict);

  FilterOptions options_;
  GateLimits limits_;
  std::vector<Entry> entries_;  ///< ring of `capacity`, sorted from first_ on
  std::size_t first_ = 0;
  std::size_t size_ = 0;
  State before_;           ///< after the measurements that left the ring
  Measurement last_left_;  ///< the newest of them
  bool any_left_ = false;
  VerdictCounts counts_{};

  // To allocate once. `ahead_`: at a whole step after the state at `ahead_of_`; empty after each measurement.
  mutable Hypotheses predicted_;
  mutable Hypotheses ahead_;
  mutable std::size_t ahead_of_ = 0;
};

}  // namespace sf::estimation
