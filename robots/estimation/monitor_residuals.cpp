// Residuals between the inputs of a monitored localization.

#include <algorithm>
#include <cmath>
#include <utility>

#include "robots/estimation/localization_monitor.h"
#include "robots/kinematics.h"

namespace sf::estimation {

namespace {

// Weights of the newest residual: turns come ten times as often as positions.
constexpr std::array<double, kRelations> kFast{0.4, 0.6, 0.6, 0.6}, kSlow{0.03, 0.2, 0.2, 0.2};
constexpr double kRoughWeight = 0.3, kRoughMemory = 0.95;
constexpr double kLargest = 1e6;           // residual: one absurd reading is forgotten after a minute
constexpr double kLeastMonitored = 1e-12;  // variance

double squared(double v) { return v * v; }

/// @param residual of unit variance
void add_residual(LocalizationMonitor::Statistic& of, std::array<double, 2> residual, double degrees, double fast,
                  double slow) {
  for (double& each : residual) each = std::clamp(each, -kLargest, kLargest);
  of.fast += fast * ((squared(residual[0]) + squared(residual[1])) / degrees - of.fast);
  for (std::size_t k = 0; k < 2; ++k) of.mean[k] += slow * (residual[k] - of.mean[k]);
  of.slow = (squared(of.mean[0]) + squared(of.mean[1])) / degrees * (2.0 - slow) / slow;
}

}  // namespace

void LocalizationMonitor::compare_with_gps(std::int64_t time, glm::dvec2 p, double hdop) {
  const double variance = std::max(0.5 * squared(options_.gps_noise * hdop), kLeastMonitored);
  for (Reckoning& each : reckonings_) {
    const auto squares = [&](const base::Pose& X) { return squared(p.x - X.x) + squared(p.y - X.y); };
    each.evidence += (squares(each.by_encoder) - squares(each.by_gyro)) / (2.0 * variance);
  }
  const bool faulty = at(MonitoredInput::gps).faulty;
  compare_position(kReckonedRelation, faulty ? main_ : older_without(MonitoredInput::gps), time, p, variance);
  if (std::ranges::any_of(inputs_, &Input::faulty)) return;
  compare_position(kWheelsRelation, older_without(MonitoredInput::gyro), time, p, variance);
  compare_position(kCourseRelation, older_without(MonitoredInput::encoder), time, p, variance);
}

/// Compares readings of one time, whichever comes last.
void LocalizationMonitor::compare_turns() {
  const Input& gyro = at(MonitoredInput::gyro);
  const auto [time, seconds, rolled] = rolled_;
  if (gyro.newest != time || !gyro.fixed || seconds > 1.0) return;
  rolled_.time = -1;
  const LocalizationOptions::Encoder& encoder = *options_.encoder;
  const auto& [left, right, track, bias, scale] = calibrations_[0];
  const double turn = (rolled[1] / right.value - rolled[0] / left.value) / (track.value * seconds);
  const double arm = squared(track.value * seconds);
  const double rounding = squared(encoder.per_count) / 6.0 + squared(track.value * encoder.angle_step) / 6.0;
  const double slip = squared(encoder.slip) * (std::abs(rolled[0]) + std::abs(rolled[1]));
  const double scales = (squared(left.sigma * rolled[0]) + squared(right.sigma * rolled[1])) / arm +
                        squared(turn * track.sigma / track.value);
  const double variance = (rounding + slip) / arm + scales + squared(options_.gyro.noise) + squared(bias.sigma);
  const double rate = gyro.values[0],
               residual = (rate - bias.value - turn) / std::sqrt(std::max(variance, kLeastMonitored));
  add_residual(statistics_[kTurnRelation], {residual, 0.0}, 1.0, kFast[kTurnRelation], kSlow[kTurnRelation]);
  const double forward = 0.5 * (rolled[0] / left.value + rolled[1] / right.value);
  for (Reckoning& each : reckonings_) {
    each.by_encoder = robots::advance(each.by_encoder, {forward, 0.0, turn * seconds}, 1.0);
    each.by_gyro = robots::advance(each.by_gyro, {forward, 0.0, (rate - bias.value) * seconds}, 1.0);
  }
  compare_roughness(rate, turn, (rounding + slip) / arm);
}

/// The true yaw rate changes both alike. @param variance [rad^2/s^2] of the encoder's
void LocalizationMonitor::compare_roughness(double rate, double turn, double variance) {
  const double by_gyro = std::abs(rate - std::exchange(compared_rate_, rate));
  const double by_encoder = std::abs(turn - std::exchange(turn_, turn));
  const double scale = 2.0 * (variance + std::sqrt(variance) * std::min(by_gyro, by_encoder)) + kLeastMonitored;
  const double rougher = (squared(by_gyro) - squared(by_encoder) + 2.0 * variance) / scale;
  mean_roughness_ += kRoughWeight * (rougher - mean_roughness_);
  roughness_ *= kRoughMemory;
  if (std::abs(mean_roughness_) > std::abs(roughness_)) roughness_ = mean_roughness_;
}

/// Of a faulty encoder, with the speed of the filter without it.
void LocalizationMonitor::compare_speed(std::int64_t time, double seconds, std::array<double, 2> rolled) {
  const Estimate estimate = main_.predict(time).estimate;
  const auto& [left, right, track, bias, scale] = calibrations_[0];
  const double forward = 0.5 * (rolled[0] / left.value + rolled[1] / right.value) / seconds;
  const double variance = estimate.covariance[kForward * (kComponents + 1)] +
                          squared(options_.encoder->per_count / seconds) / 6.0 + squared(forward * left.sigma);
  const double residual = (forward - estimate.velocity.forward) / std::sqrt(std::max(variance, kLeastMonitored));
  add_residual(statistics_[kWheelsRelation], {residual, 0.0}, 1.0, kFast[kTurnRelation], kSlow[kTurnRelation]);
}

/// @param variance [m^2] of the position, along each axis
void LocalizationMonitor::compare_position(MonitorRelation relation, const Localization& filter, std::int64_t time,
                                           glm::dvec2 p, double variance) {
  const Prediction prediction = filter.predict(time);
  if (prediction.status == Prediction::Status::none) return;
  // Cholesky factor of the innovation's covariance.
  const Covariance& P = prediction.estimate.covariance;
  const double l00 = std::sqrt(P[0] + variance), l10 = P[1] / l00;
  const double l11 = std::sqrt(std::max(P[kComponents + 1] + variance - squared(l10), kLeastMonitored));
  const double first = (p.x - prediction.estimate.X_WM.x) / l00;
  const double second = (p.y - prediction.estimate.X_WM.y - l10 * first) / l11;
  add_residual(statistics_[relation], {first, second}, 2.0, kFast[relation], kSlow[relation]);
}

}  // namespace sf::estimation
