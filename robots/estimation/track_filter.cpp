#include "robots/estimation/track_filter.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "robots/estimation/chi_square.h"

namespace sf::estimation {

namespace {

bool has_position(const Measurement& m) { return (m.components & kPositionBits) == kPositionBits; }

double distance(const Measurement& m, const Estimate& e) {
  const bool x = (m.components & 1u << kX) != 0;
  const bool y = (m.components & 1u << kY) != 0;
  return base::hypot(x ? m.X_WM.x - e.X_WM.x : 0.0, y ? m.X_WM.y - e.X_WM.y : 0.0);
}

/// Returns the motion model for a restarted track. Its prior on speeds is at least as wide as the speeds of the last
/// state plus their random walk since then.
MotionModel with_speeds_of(const MotionModel& model, const Hypotheses& last, std::int64_t time) {
  constexpr double kLongest = 10.0;  // [s] of random walk
  const double seconds = std::clamp(1e-9 * static_cast<double>(time - last[0].estimate.time), 0.0, kLongest);
  std::array<double, kComponents> squares{};
  for (const auto& [weight, e] : last) {
    const std::array<double, kComponents> speeds{0.0, 0.0, 0.0, e.velocity.forward, e.velocity.left, e.velocity.turn};
    for (std::size_t k = kForward; k <= kTurn; ++k)
      squares[k] += weight * (speeds[k] * speeds[k] + e.covariance[k * kComponents + k]);
  }
  const double speed = std::max(squares[kForward] + model.forward * seconds, squares[kLeft] + model.left * seconds);
  MotionModel wide = model;
  wide.unknown[1] = std::max(model.unknown[1], std::sqrt(speed));
  wide.unknown[2] = std::max(model.unknown[2], std::sqrt(squares[kTurn] + model.turn * seconds));
  return wide;
}

}  // namespace

std::string_view name(Verdict verdict) {
  constexpr std::array<std::string_view, kVerdicts> kNames{"started",  "used",     "outlier", "jump",   "no track",
                                                           "replayed", "too late", "future",  "invalid"};
  return kNames[static_cast<std::size_t>(verdict)];
}

GateLimits gate_limits(double gate) {
  GateLimits limits{};
  for (int degrees = 1; degrees <= static_cast<int>(kComponents); ++degrees)
    limits[degrees] = chi_square_limit(degrees, gate);
  return limits;
}

base::StateQuality quality_of(const Prediction& p) {
  const auto c = [&](int i, int j) { return static_cast<float>(p.estimate.covariance[kComponents * i + j]); };
  return {.stated = true,
          .stale = p.status == Prediction::Status::stale,
          .age = p.age,
          .covariance = {c(kX, kX), c(kX, kY), c(kX, kYaw), c(kY, kY), c(kY, kYaw), c(kYaw, kYaw)}};
}

TrackFilter::TrackFilter(const FilterOptions& options, const GateLimits& limits)
    : options_(options), limits_(limits), window_(options.window, options.capacity) {
  for (Hypotheses* each : {&predicted_, &ahead_}) each->reserve(1);
}

Verdict TrackFilter::take(const Measurement& measurement, std::int64_t now) {
  ahead_.clear();
  if (!is_valid(measurement)) return window_.count(Verdict::invalid);
  if (measurement.time > now + options_.max_future) return window_.count(Verdict::future);
  return window_.take(measurement, [&](const Measurement& m, State& state) { return apply(m, state); });
}

/// A rejected measurement leaves every bit of the state unchanged.
Verdict TrackFilter::apply(const Measurement& m, State& state) {
  const auto begin = [&] {
    state.last_position = m.time;
    const MotionModel model = state.known() ? with_speeds_of(options_.model, state.hypotheses, m.time) : options_.model;
    start(model, m, options_.hypotheses, state.hypotheses);
    return Verdict::started;
  };
  const bool position = has_position(m);
  if (!state.known() && !position) return Verdict::no_track;
  if (!state.known() || (position && m.time - state.time() > options_.stale_after)) return begin();

  const HypothesesLimits limits{options_.hypotheses, state.time()};
  predicted_ = state.hypotheses;
  estimation::predict(options_.model, m.time, limits, predicted_);
  const Innovation surprise = innovation(predicted_, m);
  const bool far = distance(m, most_probable(predicted_)) > options_.max_jump;
  // `!(a <= b)` rejects NaN as well.
  if (far || !(surprise.squared <= limits_[surprise.degrees])) {
    // The object was carried elsewhere: its positions are rejected for stale_after, then accepted.
    if (position && m.time - state.last_position > options_.stale_after) return begin();
    return far ? Verdict::jump : Verdict::outlier;
  }
  correct(options_.model, m, limits, predicted_);
  state.hypotheses = predicted_;
  if (position) state.last_position = m.time;
  return Verdict::used;
}

Prediction TrackFilter::predict(std::int64_t time) const {
  const State* state = window_.state_at(time);
  if (state == nullptr) return {};

  const Estimate& last = most_probable(state->hypotheses);
  Prediction prediction{Prediction::Status::fresh, time - last.time, estimation::predict(options_.model, last, time)};
  Estimate& estimate = prediction.estimate;
  const bool stale = prediction.age > options_.stale_after;
  const bool one = state->hypotheses.size() == 1 && has_certain_heading(estimate);
  const bool many = !one && options_.hypotheses > 1;
  if (many)
    advance_to(time, *state);
  else if (stale)
    predicted_.assign(1, {1.0, estimate});
  if (stale) {
    prediction.status = Prediction::Status::stale;
    estimate.X_WM = estimation::predict(options_.model, last, last.time + options_.stale_after).X_WM;
    estimate.velocity = {};
  }
  if (many || stale) estimate.covariance = covariance_about(estimate, predicted_);
  return prediction;
}

/// Sets `predicted_` to the hypotheses at `time`. Later predictions continue from the last whole step of earlier ones.
void TrackFilter::advance_to(std::int64_t time, const State& newest) const {
  const HypothesesLimits limits{options_.hypotheses, newest.time()};
  const std::int64_t steps = (time - limits.corrected) / kHypothesesStep;
  const std::int64_t whole =
      limits.corrected + std::clamp(steps, std::int64_t{0}, kMostHypothesesSteps) * kHypothesesStep;
  if (ahead_.empty() || ahead_of_ != &newest || ahead_[0].estimate.time > whole) ahead_ = newest.hypotheses;
  ahead_of_ = &newest;
  advance(options_.model, whole, limits, ahead_);
  predicted_ = ahead_;
  advance(options_.model, time, limits, predicted_);
}

void TrackFilter::reset() {
  window_.clear();
  ahead_.clear();
}

}  // namespace sf::estimation
