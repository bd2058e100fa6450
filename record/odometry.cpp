#include "record/odometry.h"

#include <cmath>
#include <utility>

#include "base/displacement.h"
#include "base/elementary.h"

namespace sf::record {

namespace {

/// Returns the covariance of the state's error along the axes of a frame whose yaw in the world is `yaw`.
std::array<double, 6> turned(const std::array<float, 6>& P, double yaw) {
  const auto [s, c] = base::sin_cos(yaw);
  const double xx = P[0], xy = P[1], xa = P[2], yy = P[3], ya = P[4];
  return {c * c * xx + 2 * c * s * xy + s * s * yy,
          c * s * (yy - xx) + (c * c - s * s) * xy,
          c * xa + s * ya,
          s * s * xx - 2 * c * s * xy + c * c * yy,
          c * ya - s * xa,
          P[5]};
}

/// Adds `variance` along the vector (x, y, yaw).
void add_along(std::array<double, 6>& P, double x, double y, double yaw, double variance) {
  const double terms[6] = {x * x, x * y, x * yaw, y * y, y * yaw, yaw * yaw};
  for (int i = 0; i < 6; ++i) P[i] += variance * terms[i];
}

constexpr OdometryCovariance kExact{{kLeastVariance, 0.0, 0.0, kLeastVariance, 0.0, kLeastVariance},
                                    {kLeastVariance, 0.0, kLeastVariance},
                                    kLeastVariance};

}  // namespace

Odometer::Odometer(const MoverInfo& mover, OdometrySource source)
    : encoder_(source == OdometrySource::encoders ? mover.encoder : std::nullopt),
      truth_(source == OdometrySource::truth),
      max_forward_(mover.max_forward) {}

void Odometer::begin() {
  state_ = {};
  errors_ = {};
  left_ = right_ = 0.0;
  counted_ = {};
  away_ = false;
}

void Odometer::move(std::int64_t time, const base::Pose& X_WM, const base::Twist& velocity,
                    const base::StateQuality& quality, const base::Tilt& tilt) {
  if (!truth_) {
    const base::Pose before = base::compose(state_.X_WO, state_.X_OM);
    const double seconds = 1e-9 * static_cast<double>(time - state_.time);
    if (state_.time < 0 || std::exchange(away_, false) || !base::is_drivable(before, X_WM, max_forward_, seconds))
      state_.X_WO = base::compose(X_WM, base::inverse(state_.X_OM));
  }
  state_.X_OM = base::compose(base::inverse(state_.X_WO), X_WM);
  state_.time = time;
  state_.velocity = velocity;
  state_.tilt = tilt;
  state_.covariance = truth_ ? OdometryCovariance{} : kExact;
  if (quality.stated) state_.covariance = {turned(quality.covariance, state_.X_WO.yaw), {}, kLeastVariance};
}

bool Odometer::roll(const base::ReadingBlock& encoder) {
  if (encoder.time == state_.time) return true;
  if (encoder.time < state_.time || encoder.values.size() < 2) return false;
  const double left = encoder.values[0] - std::exchange(left_, encoder.values[0]);
  const double right = encoder.values[1] - std::exchange(right_, encoder.values[1]);
  const double seconds = 1e-9 * static_cast<double>(encoder.time - std::max<std::int64_t>(0, state_.time));
  const double way = 0.5 * (left + right), turn = (right - left) / encoder_->track, half = 0.5 * turn;
  const double chord = std::abs(half) < 1e-4 ? way : way * base::sin(half) / half;

  const double middle = state_.X_OM.yaw + half;
  propagate(left, right, middle);
  const glm::dvec2 step = base::rotate(middle, {chord, 0.0});
  base::Pose& X_OM = state_.X_OM;
  X_OM = {X_OM.x + step.x, X_OM.y + step.y, 0.0, base::wrap_angle(X_OM.yaw + turn)};
  state_.X_WO = base::compose(encoder.X_WM, base::inverse(X_OM));
  state_.time = encoder.time;
  state_.tilt = encoder.tilt;
  state_.velocity = seconds > 0.0 ? base::Twist{way / seconds, 0.0, turn / seconds} : base::Twist{};
  state_covariance(left, right, seconds);
  return true;
}

/// Advances the errors by one step. @param middle [rad] heading at half the step
void Odometer::propagate(double left, double right, double middle) {
  const double half = 0.5 * (right - left) / encoder_->track, way = 0.5 * (left + right);
  const double chord = std::abs(half) < 1e-4 ? way : way * base::sin(half) / half;
  const Errors::Complex along = std::polar(1.0, middle);
  add_slip(left, right, chord, along);
  add_rounding(left, right, chord * along);
}

/// D grows by (way + a) along exp(i (e + n / 2)) - way along, and e by n: the mean over normal errors a of the way and
/// n of the turn, by E exp(i k n) = exp(-k^2 n^2 / 2) and E a f(n) = E[a n] E f'(n).
void Odometer::add_slip(double left, double right, double way, Errors::Complex along) {
  using Complex = Errors::Complex;
  const double track = encoder_->track, slip2 = encoder_->slip * encoder_->slip;
  const double nn = slip2 * (std::abs(left) + std::abs(right)) / (track * track);
  const double aa = slip2 * (std::abs(left) + std::abs(right)) / 4.0;
  const Complex an(0.0, slip2 * (std::abs(right) - std::abs(left)) / (2.0 * track));
  const Errors before = errors_;
  const double e1 = base::exp(-0.5 * before.yaw), e2 = base::exp(-2.0 * before.yaw);  // of exp(ie), exp(2ie)
  const double n1 = base::exp(-0.125 * nn), n2 = base::exp(-0.5 * nn), n3 = base::exp(-1.125 * nn);
  const Complex step = way * along, mean = n1 * along * (way + 0.5 * an);
  const Complex square = n2 * along * along * ((way + an) * (way + an) + aa);
  Errors& now = errors_;
  now.position += mean * e1 - step;
  now.norm += 2.0 * std::real(mean * std::conj(before.back) - step * std::conj(before.position)) + 2.0 * way * way +
              aa - 2.0 * e1 * std::real(std::conj(step) * mean);
  now.square +=
      2.0 * (mean * before.turned - step * before.position) + e2 * square - 2.0 * e1 * step * mean + step * step;
  now.turned = n2 * before.turned + n3 * e2 * along * (way + 1.5 * an) - n2 * e1 * step;
  now.back = n2 * before.back + n1 * along * (way - 0.5 * an) - n2 * e1 * step;
  now.with_yaw +=
      e1 * (Complex(0.0, before.yaw) * mean + n1 * along * ((way + 0.5 * an) * Complex(0.0, 0.5 * nn) + std::imag(an)));
  now.yaw += nn;
}

void Odometer::add_rounding(double left, double right, Errors::Complex step) {
  const double count = encoder_->per_count;
  const std::array<double, 2> counts{std::round(left / count), std::round(right / count)};
  const bool rests = counts == std::array<double, 2>{};
  if (!rests && counts != counted_) errors_.with_rounded = 0.0;
  if (!rests) counted_ = counts;
  const double variance = count * count / (6.0 * encoder_->track * encoder_->track);
  const Errors::Complex sideways = Errors::Complex(0.0, 1.0) * step;
  errors_.norm += 2.0 * std::real(std::conj(errors_.with_rounded) * sideways) + std::norm(step) * variance;
  errors_.square += 2.0 * sideways * errors_.with_rounded + sideways * sideways * variance;
  errors_.with_rounded += sideways * variance;
}

/// Sets the stated covariance, which includes the rounding of the last counts and is at least kLeastVariance.
void Odometer::state_covariance(double left, double right, double seconds) {
  const double count2 = encoder_->per_count * encoder_->per_count, slip2 = encoder_->slip * encoder_->slip;
  const double track = encoder_->track, yaw = state_.X_OM.yaw;
  OdometryCovariance& stated = state_.covariance = kExact;
  const Errors& e = errors_;
  const Errors::Complex with_yaw = e.with_yaw + e.with_rounded;
  const double walked[6] = {0.5 * (e.norm + e.square.real()), 0.5 * e.square.imag(), with_yaw.real(),
                            0.5 * (e.norm - e.square.real()), with_yaw.imag(),       e.yaw};
  for (std::size_t i = 0; i < stated.pose.size(); ++i) stated.pose[i] += walked[i];
  add_along(stated.pose, base::cos(yaw), base::sin(yaw), 0.0, count2 / 24.0);
  stated.pose[5] += count2 / (6.0 * track * track);
  if (seconds <= 0.0) return;
  const double dl = (count2 / 6.0 + slip2 * std::abs(left)) / (seconds * seconds);
  const double dr = (count2 / 6.0 + slip2 * std::abs(right)) / (seconds * seconds);
  stated.twist[0] += 0.25 * (dl + dr);
  stated.twist[1] += 0.5 * (dr - dl) / track;
  stated.twist[2] += (dl + dr) / (track * track);
}

}  // namespace sf::record
