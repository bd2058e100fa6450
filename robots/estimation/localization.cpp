#include "robots/estimation/localization.h"

#include <algorithm>
#include <cmath>

namespace sf::estimation {

namespace {

constexpr double kLeastVariance = 1e-12;
constexpr std::int64_t kStand = 1'000'000'000;    // [ns] without a count; shorter pauses occur in slow turns
constexpr std::int64_t kBiasApart = 200'000'000;  // [ns] largest time between gyro and wheel readings
constexpr double kBiasGate = 16.0;                // squared, for 4 standard deviations

FilterOptions filter_options() {
  FilterOptions options{.model = differential_drive()};
  // After a long time under a bridge, a position that the gate rejects must not restart the track without a heading.
  options.stale_after = 60'000'000'000;
  // A window of one second with encoder and gyro at 250 Hz each, and GPS.
  options.capacity = 512;
  return options;
}

}  // namespace

Localization::Localization(const LocalizationOptions& options, const base::Pose& X_WM, std::int64_t time)
    : options_(options), filter_(filter_options()), bias_variance_(options.gyro.bias * options.gyro.bias) {
  const double position = options.start_position * options.start_position;
  Measurement start{.time = time, .X_WM = X_WM};
  start.pose_covariance = {position, 0.0, 0.0, position, 0.0, options.start_yaw * options.start_yaw};
  take(0, start);
}

Verdict Localization::take(std::uint32_t source, Measurement measurement) {
  measurement.source = source;
  measurement.sequence = sequence_++;
  return filter_.take(measurement, measurement.time);
}

void Localization::add_encoder(std::int64_t time, double left, double right) {
  if (!std::isfinite(left) || !std::isfinite(right) || (last_ && time <= last_->time)) return;
  const std::optional<Rolled> before = last_;
  last_ = {time, left, right};
  if (!before) {
    last_count_ = time;
    return;
  }
  const double dt = 1e-9 * static_cast<double>(time - before->time);
  const double dl = left - before->left, dr = right - before->right;
  if (dl != 0.0 || dr != 0.0) last_count_ = time;

  // Rounding of two counts, and slip over each wheel's path.
  const auto variance = [&](double way) {
    const LocalizationOptions& o = options_;
    return std::max(o.encoder.per_count * o.encoder.per_count / 6.0 + o.encoder.slip * o.encoder.slip * std::abs(way),
                    kLeastVariance);
  };
  const double both = variance(dl) + variance(dr), track = options_.encoder.track;
  Measurement speeds{.time = before->time + (time - before->time) / 2, .components = 1u << kForward | 1u << kTurn};
  speeds.velocity = {0.5 * (dl + dr) / dt, 0.0, (dr - dl) / (track * dt)};
  speeds.twist_variance = {0.25 * both / (dt * dt), 1.0, both / (track * track * dt * dt)};
  if (take(1, speeds) != Verdict::used) return;
  wheels_turn_ = {speeds.time, speeds.velocity.turn, speeds.twist_variance[2]};
  if (time - last_count_ < kStand) return;
  const double still = track * 1e-9 * static_cast<double>(time - last_count_);
  wheels_turn_ = {time, 0.0, 2.0 * variance(0.0) / (still * still)};
}

void Localization::add_gyro(std::int64_t time, double rate) {
  if (!std::isfinite(rate)) return;
  const double noise = std::max(options_.gyro.noise * options_.gyro.noise, kLeastVariance);
  Measurement turn{.time = time, .components = 1u << kTurn};
  turn.velocity.turn = rate - bias_;
  turn.twist_variance[2] = noise + bias_variance_;
  if (take(2, turn) == Verdict::used) learn_bias(time, rate, noise);
}

void Localization::learn_bias(std::int64_t time, double rate, double noise) {
  if (!wheels_turn_) return;
  const Turn wheels = *wheels_turn_;
  wheels_turn_.reset();
  const double surprise = rate - wheels.rate - bias_, variance = bias_variance_ + noise + wheels.variance;
  if (std::abs(time - wheels.time) > kBiasApart || surprise * surprise > kBiasGate * variance) return;
  const double gain = bias_variance_ / variance;
  bias_ += gain * surprise;
  bias_variance_ *= 1.0 - gain;
}

void Localization::add_gps(std::int64_t time, double x, double y, double hdop) {
  if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(hdop)) return;
  // Readings contain the sum of both axes' dilution.
  const double variance = std::max(0.5 * options_.gps_noise * options_.gps_noise * hdop * hdop, kLeastVariance);
  Measurement position{.time = time, .components = kPositionBits, .X_WM = {x, y}};
  position.pose_covariance = {variance, 0.0, 0.0, variance, 0.0, 1.0};
  take(3, position);
}

}  // namespace sf::estimation
