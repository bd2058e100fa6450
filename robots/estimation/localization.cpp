#include "robots/estimation/localization.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/elementary.h"
#include "robots/estimation/landmark_pose.h"

namespace sf::estimation {

namespace {

using Kind = WheeledMeasurement::Kind;

constexpr double kLeastVariance = 1e-12;
constexpr double kGate = 1e-4;      // probability that a correct measurement is rejected
constexpr int kMostRejected = 5;    // in succession, of a robot that was not relocated
constexpr int kStartHeadings = 36;  // of a start without a heading
constexpr double kLeastShare = 1e-6;
constexpr std::size_t kMostSightings = 4;  // of one time, until they start a pose
// A window of one second with encoders and gyro at 250 Hz each, and poses.
constexpr std::size_t kCapacity = 576, kFirstCapacity = 8;
constexpr double kFastest = 10.0;  // [m/s] encoders that differ from the prediction by more were reset, or are wrong

constexpr double kLeastChange = 32.0;  // of a turn rate, squared, in variances of the gyro's noise

constexpr double kLagShare = 0.02;                         // of a fix in the mean innovation
constexpr double kMostLag = 0.6;                           // of a mean innovation by chance: six standard deviations
constexpr int kLagFixes = 100;                             // until the mean has its distribution
constexpr double kLeastForward = 0.02, kLeastTurn = 0.05;  // [m/s], [rad/s] of fixes that show slips

double square(double v) { return v * v; }

/// Returns whether the kind can start a pose.
bool is_fix(Kind kind) { return kind == Kind::pose || kind == Kind::position; }

/// A state at rest at the origin, with the prior of all constants.
WheeledState prior_of(const LocalizationOptions& options, const WheeledModel& model) {
  WheeledState state{.mean = {}};
  const auto& unknown = model.motion.unknown;
  set_variance(state, kForward, square(unknown[1]));
  if (options.sideways) set_variance(state, kLeft, square(unknown[1]));
  set_variance(state, kTurn, square(unknown[2]));
  for (const int k : {kLeftScale, kRightScale, kTrackScale, kGyroScale}) state.mean[k] = 1.0;
  if (options.encoder) {
    const double common = square(options.encoder->scale_sigma), half = square(0.5 * options.encoder->difference_sigma);
    for (const int k : {kLeftScale, kRightScale}) set_variance(state, k, common + half);
    set_covariance(state, kLeftScale, kRightScale, common - half);
    set_variance(state, kTrackScale, square(options.encoder->track_sigma));
  }
  set_variance(state, kGyroBias, square(options.gyro.bias));
  set_variance(state, kGyroScale, square(options.gyro.scale));
  return state;
}

template <class Hypothesis>
const Hypothesis& heaviest(const std::vector<Hypothesis>& all) {
  return *std::max_element(all.begin(), all.end(), [](auto& a, auto& b) { return a.weight < b.weight; });
}

/// Removes improbable hypotheses, and merges neighbours whose headings have become alike.
template <class Hypothesis>
void reduce(std::vector<Hypothesis>& all) {
  if (all.size() == 1) return;
  std::erase_if(all, [](const Hypothesis& each) { return each.weight < kLeastShare; });
  for (std::size_t k = 0; all.size() > 1 && k < all.size();) {
    Hypothesis& next = all[(k + 1) % all.size()];
    const double apart = std::abs(base::wrap_angle(all[k].state.mean[kYaw] - next.state.mean[kYaw]));
    if (square(apart) > 0.25 * all[k].state.covariance[kYaw * (kWheeledComponents + 1)]) {
      ++k;
      continue;
    }
    next.state = merged(next.weight, next.state, all[k].weight, all[k].state);
    next.weight += all[k].weight;
    all.erase(all.begin() + static_cast<std::ptrdiff_t>(k));
  }
}

/// Variance and covariance [m^2] of the wheels' distances by rounding.
struct Rounding {
  double each, both;
};
Rounding rounding_of(const LocalizationOptions::Encoder& encoder) {
  if (encoder.angle_step == 0.0) return {std::max(square(encoder.per_count) / 12.0, kLeastVariance), 0.0};
  const double distance = std::max(square(encoder.per_count) / 3.0, kLeastVariance);
  const double angle = square(0.5 * encoder.track * encoder.angle_step) / 3.0;
  return {distance + angle, distance - angle};
}

/// The error of rounding is constant while the robot is at rest or drives straight on: more readings do not reduce it.
/// That of a coarse angle turns the path since the last fix.
void add_rounding(const LocalizationOptions::Encoder& encoder, glm::dvec2 fixed, Estimate& estimate) {
  Covariance& P = estimate.covariance;
  const auto at = [&](int i, int k) -> double& { return P[i * kComponents + k]; };
  if (encoder.angle_step > 0.0) {
    const double distance = square(encoder.per_count) / 3.0, angle = square(encoder.angle_step) / 3.0;
    const std::array<double, 3> J{fixed.y - estimate.X_WM.y, estimate.X_WM.x - fixed.x, 1.0};
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) at(i, k) += angle * J[i] * J[k];
    for (const int k : {kX, kY}) at(k, k) = std::max(at(k, k), distance);
    return;
  }
  const double rounding = square(encoder.per_count) / 12.0;
  for (const int k : {kX, kY}) at(k, k) = std::max(at(k, k), rounding);
  at(kYaw, kYaw) = std::max(at(kYaw, kYaw), 2.0 * rounding / square(encoder.track));
}

/// Encoders measure the mean turn rate since their last reading, a gyro that of the moment. Where a command changed it
/// in between, both differ by a share of the change that is unknown, and uniform if commands come at any time.
WheeledMeasurement widened(const WheeledState& before, WheeledMeasurement m) {
  const double change =
      (m.values[0] - before.mean[kGyroBias]) / std::max(before.mean[kGyroScale], 0.5) - before.mean[kTurn];
  if (square(change) > kLeastChange * m.covariance[0]) m.covariance[0] += square(change) / 3.0;
  return m;
}

/// Returns whether encoders counted more since `before` [ns] than wheels can roll.
bool was_reset(const WheeledState& predicted, const WheeledMeasurement& m, std::int64_t before) {
  const double seconds = 1e-9 * static_cast<double>(std::abs(m.time - before));
  const double left = m.values[0] - predicted.mean[kLeftRolled], right = m.values[1] - predicted.mean[kRightRolled];
  return std::max(std::abs(left), std::abs(right)) > kFastest * (seconds + 1.0);
}

}  // namespace

Localization::Localization(const LocalizationOptions& options)
    : options_(options),
      model_(model_of(options, options.encoder.has_value())),
      window_(kWindow, kCapacity, kFirstCapacity) {}

/// With encoders, the readings show how commands change the speeds. Without them, inertia has to bridge the gaps
/// between poses.
WheeledModel Localization::model_of(const LocalizationOptions& options, bool encoder) {
  WheeledModel model{.motion = encoder ? differential_drive(4.0, 40.0) : differential_drive(), .steps = encoder};
  if (options.sideways) model.motion.left = model.motion.forward;
  if (const auto& tyres = options.tyres)
    model.axle = tyres->axle, model.sideslip = tyres->sideslip, model.drift = tyres->drift;
  if (!options.encoder) return model;
  model.track = options.encoder->track;
  model.slip = options.encoder->slip;
  return model;
}

void Localization::resume_encoder() {
  model_ = model_of(options_, options_.encoder.has_value());
  window_.for_each_state([](State& state) { state.rolled = false, state.counted_at = -1; });
}

Verdict Localization::add_encoder(std::int64_t time, double left, double right) {
  if (!options_.encoder) return Verdict::invalid;
  const auto [each, both] = rounding_of(*options_.encoder);
  return take({time, Kind::encoder, 0, {left, right, 0.0}, {each, both, 0.0, each, 0.0, 1.0}});
}

Verdict Localization::add_gyro(std::int64_t time, double rate) {
  const double variance = std::max(square(options_.gyro.noise), kLeastVariance);
  return take({time, Kind::gyro, 0, {rate, 0.0, 0.0}, {variance, 0.0, 0.0, 1.0, 0.0, 1.0}});
}

Verdict Localization::add_gps(std::int64_t time, double x, double y, double hdop) {
  // Readings contain the sum of both axes' dilution.
  const double variance = std::max(0.5 * square(options_.gps_noise * hdop), kLeastVariance);
  return take({time, Kind::position, 0, {x, y, 0.0}, {variance, 0.0, 0.0, variance, 0.0, 1.0}});
}

Verdict Localization::add_pose(std::int64_t time, const base::Pose& X_WM, const std::array<double, 6>& covariance) {
  return take({time, Kind::pose, 0, {X_WM.x, X_WM.y, X_WM.yaw}, covariance, X_WM.z});
}

Verdict Localization::add_sighting(std::int64_t time, const glm::dvec2& landmark, const glm::dvec2& seen,
                                   const std::array<double, 3>& covariance) {
  const auto [xx, xy, yy] = covariance;
  return take({.time = time,
               .kind = Kind::sighting,
               .values = {seen.x, seen.y, 0.0},
               .covariance = {xx, xy, 0.0, yy, 0.0, 1.0},
               .landmark = {landmark.x, landmark.y}});
}

Verdict Localization::take(WheeledMeasurement measurement) {
  if (!is_valid(measurement)) return window_.count(Verdict::invalid);
  measurement.sequence = sequence_++;
  return window_.take(measurement, [&](const WheeledMeasurement& m, State& state) { return apply(m, state); });
}

/// A rejected measurement leaves the hypotheses unchanged.
Verdict Localization::apply(const WheeledMeasurement& reading, State& state) {
  const bool turned = reading.kind == Kind::gyro && model_.steps && state.known();
  const WheeledMeasurement m = turned ? widened(heaviest(state.hypotheses).state, reading) : reading;
  const bool encoder = m.kind == Kind::encoder;
  if (!state.known()) {
    if (encoder) state.counted_at = m.time, state.counted = {m.values[0], m.values[1]};
    if (m.kind == Kind::sighting) return start_by_sightings(m, state);
    return is_fix(m.kind) ? start(m, state) : Verdict::no_track;
  }
  if (encoder && !state.rolled) start_encoders(m, state);
  predicted_ = state.hypotheses;
  for (Weighted& each : predicted_) each.state = estimation::predict(model_, each.state, m.time);
  if (encoder && was_reset(predicted_[0].state, m, state.time())) {
    for (Weighted& each : predicted_) replace(each.state, m);
    state.hypotheses = predicted_;
    return Verdict::outlier;
  }
  // Spikes of the gyro are not changes of the rate.
  const Innovation surprise = weigh(reading);
  // Encoders are not gated, since commands change the speeds at once. `!(a <= b)` rejects NaN as well.
  static const GateLimits kLimits = gate_limits(kGate);
  if (!encoder && !(surprise.squared <= kLimits[surprise.degrees])) return reject(m, state);
  if (options_.learn_slip && options_.encoder && is_fix(m.kind) && predicted_.size() == 1) watch_slip(m, state);
  for (Weighted& each : predicted_) each.state = correct(each.state, m);
  reduce(predicted_);
  state.hypotheses = predicted_;
  if (!is_fix(m.kind) && m.kind != Kind::sighting) return Verdict::used;
  const auto& mean = heaviest(predicted_).state.mean;
  state.last_fix = m.time, state.fixed = {mean[kX], mean[kY]};
  state.rejected = 0;
  return Verdict::used;
}

/// The encoders show only afterwards whether the velocity changed before a fix, as commands do: such fixes are left
/// out, since robots that start and stop would be behind their prediction in the mean.
void Localization::Lag::add(double innovation, double velocity, double least) {
  if (std::abs(velocity_before) > least && std::abs(velocity - velocity_before) < 0.2 * std::abs(velocity_before)) {
    const double ahead = std::copysign(1.0, velocity_before) * innovation_before;
    mean += kLagShare * (ahead - mean);
    square += kLagShare * (ahead * ahead - square);
    ++count;
  }
  innovation_before = innovation, velocity_before = velocity;
}

bool Localization::Lag::lasts() const { return count >= kLagFixes && mean * mean > kMostLag * kMostLag * square; }

/// A slip that lasts changes the scales, as on another floor: fixes are then behind the prediction, or ahead of it, for
/// longer than by chance. The scales are unknown again, each on its own: one wheel may slip alone.
void Localization::watch_slip(const WheeledMeasurement& m, State& state) {
  WheeledState& s = predicted_[0].state;
  const glm::dvec2 d{m.values[0] - s.mean[kX], m.values[1] - s.mean[kY]};
  state.ahead.add(glm::dot(base::rotate(s.mean[kYaw], {1.0, 0.0}), d), s.mean[kForward], kLeastForward);
  if (m.kind == Kind::pose) state.turned.add(base::wrap_angle(m.values[2] - s.mean[kYaw]), s.mean[kTurn], kLeastTurn);
  if (!state.ahead.lasts() && !state.turned.lasts()) return;
  for (const int k : {kLeftScale, kRightScale})
    s.covariance[k * (kWheeledComponents + 1)] += square(options_.encoder->scale_sigma);
  state.ahead = state.turned = {};
}

/// Sets the distances at the time of the state, between the last encoder reading before the start and the first after
/// it; the wheels turn evenly in between.
void Localization::start_encoders(const WheeledMeasurement& m, State& state) const {
  const double gap = static_cast<double>(m.time - state.counted_at);
  const bool between = state.counted_at >= 0 && state.counted_at <= state.time() && state.time() < m.time;
  const double left = between ? static_cast<double>(m.time - state.time()) / gap : 0.0;  // share of the gap
  WheeledMeasurement then = m;
  for (const std::size_t k : {0, 1}) then.values[k] -= left * (m.values[k] - state.counted[k]);
  for (Weighted& each : state.hypotheses) {
    if (!between) each.state = estimation::predict(model_, each.state, m.time);
    replace(each.state, then);
  }
  state.rolled = true;
}

/// Starts or restarts the pose. The constants remain, as do the distances rolled by the time of the measurement.
Verdict Localization::start(const WheeledMeasurement& m, State& state) const {
  WheeledState first = prior_of(options_, model_);
  if (state.known()) first = estimation::predict(model_, heaviest(state.hypotheses).state, m.time);
  first.time = m.time;
  replace(first, m);
  state.last_fix = m.time, state.fixed = {first.mean[kX], first.mean[kY]};
  state.rejected = 0;
  state.hypotheses.assign(1, {1.0, first});
  if (m.kind == Kind::pose) return Verdict::started;

  constexpr double kApart = 2.0 * M_PI / kStartHeadings;
  set_variance(first, kYaw, square(0.5 * kApart));
  state.hypotheses.assign(kStartHeadings, {1.0 / kStartHeadings, first});
  for (int k = 0; k < kStartHeadings; ++k) state.hypotheses[k].state.mean[kYaw] = base::wrap_angle(k * kApart);
  return Verdict::started;
}

/// All sightings of one time so far have to agree. Those that start a pose do not correct it again.
Verdict Localization::start_by_sightings(const WheeledMeasurement& m, State& state) const {
  std::vector<WheeledMeasurement>& all = state.sightings;
  if (!all.empty() && all.front().time != m.time) all.clear();
  if (all.size() < kMostSightings) all.push_back(m);
  std::optional<WheeledMeasurement> pose = pose_of(all);
  if (!pose) return state.known() ? Verdict::outlier : Verdict::no_track;
  if (state.known()) pose->z = state.hypotheses[0].state.z;
  all.clear();
  return start(*pose, state);
}

Verdict Localization::reject(const WheeledMeasurement& m, State& state) const {
  const bool sighted = m.kind == Kind::sighting;
  if (!is_fix(m.kind) && !sighted) return Verdict::outlier;
  const std::int64_t patience = m.kind == Kind::position ? kRelocatedPositions : kRelocated;
  if (++state.rejected <= kMostRejected || m.time - state.last_fix <= patience) return Verdict::outlier;
  return sighted ? start_by_sightings(m, state) : start(m, state);
}

/// Weighs the predicted hypotheses by the likelihood of a measurement. Returns the least innovation: a measurement is
/// an outlier only if no hypothesis explains it.
Innovation Localization::weigh(const WheeledMeasurement& m) {
  Innovation least{.squared = HUGE_VAL};
  double most = -HUGE_VAL;
  if (predicted_.size() == 1) return innovation(predicted_[0].state, m);
  for (Weighted& each : predicted_) {
    const Innovation surprise = innovation(each.state, m);
    if (!(surprise.squared >= least.squared)) least = surprise;
    each.weight = base::log(each.weight) - 0.5 * (surprise.squared + surprise.log_determinant);
    most = std::max(most, each.weight);
  }
  double sum = 0.0;
  for (Weighted& each : predicted_) sum += each.weight = base::exp(each.weight - most);
  for (Weighted& each : predicted_) each.weight /= sum;
  return least;
}

Prediction Localization::predict(std::int64_t time) const {
  const State* state = window_.state_at(time);
  if (state == nullptr) return {};
  const auto at_time = [&](const WheeledState& each) { return estimate_of(estimation::predict(model_, each, time)); };
  Prediction prediction{Prediction::Status::fresh, time - state->last_fix, {}};
  Covariance& P = prediction.estimate.covariance;
  if (state->hypotheses.size() == 1) {
    prediction.estimate = at_time(state->hypotheses.front().state);
  } else {
    Hypotheses all;
    for (const auto& [weight, each] : state->hypotheses) all.push_back({weight, at_time(each)});
    prediction.estimate = estimation::most_probable(all);
    P = covariance_about(prediction.estimate, all);
  }
  if (!options_.encoder) return prediction;
  add_rounding(*options_.encoder, state->fixed, prediction.estimate);
  return prediction;
}

Calibration Localization::calibration() const {
  const State* state = window_.state_at(INT64_MAX);
  const WheeledState s = state != nullptr ? heaviest(state->hypotheses).state : prior_of(options_, model_);
  const auto constant = [&](int k, double unit) {
    return Constant{unit * s.mean[k], unit * std::sqrt(s.covariance[k * kWheeledComponents + k])};
  };
  return {constant(kLeftScale, 1.0), constant(kRightScale, 1.0), constant(kTrackScale, model_.track),
          constant(kGyroBias, 1.0), constant(kGyroScale, 1.0)};
}

}  // namespace sf::estimation
