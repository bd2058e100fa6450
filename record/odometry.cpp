#include "record/odometry.h"

#include <cmath>
#include <utility>

#include "base/displacement.h"

namespace sf::record {

namespace {

base::Pose inverse(const base::Pose& X_AB) {
  const glm::dvec2 p = base::rotate(-X_AB.yaw, {-X_AB.x, -X_AB.y});
  return {p.x, p.y, -X_AB.z, -X_AB.yaw};
}

/// Of the state's error along the axes of a frame whose yaw in the world is `yaw`.
std::array<double, 6> turned(const std::array<float, 6>& P, double yaw) {
  const double c = std::cos(yaw), s = std::sin(yaw);
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
  walked_ = {};
  left_ = right_ = 0.0;
  away_ = false;
}

void Odometer::move(std::int64_t time, const base::Pose& X_WM, const base::Twist& velocity,
                    const base::StateQuality& quality) {
  if (!truth_) {
    const base::Pose before = base::compose(state_.X_WO, state_.X_OM);
    const double seconds = 1e-9 * static_cast<double>(time - state_.time);
    if (state_.time < 0 || std::exchange(away_, false) || !base::is_drivable(before, X_WM, max_forward_, seconds))
      state_.X_WO = base::compose(X_WM, inverse(state_.X_OM));
  }
  state_.X_OM = base::compose(inverse(state_.X_WO), X_WM);
  state_.time = time;
  state_.velocity = velocity;
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
  const double chord = std::abs(half) < 1e-4 ? way : way * std::sin(half) / half;

  const double middle = state_.X_OM.yaw + half;
  propagate(left, right, middle);
  const glm::dvec2 step = base::rotate(middle, {chord, 0.0});
  base::Pose& X_OM = state_.X_OM;
  X_OM = {X_OM.x + step.x, X_OM.y + step.y, 0.0, base::wrap_angle(X_OM.yaw + turn)};
  state_.X_WO = base::compose(encoder.X_WM, inverse(X_OM));
  state_.time = encoder.time;
  state_.velocity = seconds > 0.0 ? base::Twist{way / seconds, 0.0, turn / seconds} : base::Twist{};
  state_covariance(left, right, seconds);
  return true;
}

/// One step of the pose's covariance. @param middle [rad] heading half way
void Odometer::propagate(double left, double right, double middle) {
  const double track = encoder_->track, way = 0.5 * (left + right), slip2 = encoder_->slip * encoder_->slip;
  const double c = std::cos(middle), s = std::sin(middle), dx = way * c, dy = way * s;
  auto& P = walked_;
  // x and y move with the error of the heading: F = [1 0 -dy; 0 1 dx; 0 0 1].
  P = {P[0] - 2 * dy * P[2] + dy * dy * P[5],
       P[1] + dx * P[2] - dy * P[4] - dx * dy * P[5],
       P[2] - dy * P[5],
       P[3] + 2 * dx * P[4] + dx * dx * P[5],
       P[4] + dx * P[5],
       P[5]};
  const double lever = way / (2.0 * track);
  add_along(P, 0.5 * c + lever * s, 0.5 * s - lever * c, -1.0 / track, slip2 * std::abs(left));
  add_along(P, 0.5 * c - lever * s, 0.5 * s + lever * c, 1.0 / track, slip2 * std::abs(right));
  const double rounded_yaw = encoder_->per_count * encoder_->per_count / (6.0 * track * track);
  add_along(P, -dy, dx, 0.0, rounded_yaw);
}

/// As stated: with the rounding of the last counts, and at least kLeastVariance.
void Odometer::state_covariance(double left, double right, double seconds) {
  const double count2 = encoder_->per_count * encoder_->per_count, slip2 = encoder_->slip * encoder_->slip;
  const double track = encoder_->track, yaw = state_.X_OM.yaw;
  OdometryCovariance& stated = state_.covariance = kExact;
  for (std::size_t i = 0; i < walked_.size(); ++i) stated.pose[i] += walked_[i];
  add_along(stated.pose, std::cos(yaw), std::sin(yaw), 0.0, count2 / 24.0);
  stated.pose[5] += count2 / (6.0 * track * track);
  if (seconds <= 0.0) return;
  const double dl = (count2 / 6.0 + slip2 * std::abs(left)) / (seconds * seconds);
  const double dr = (count2 / 6.0 + slip2 * std::abs(right)) / (seconds * seconds);
  stated.twist[0] += 0.25 * (dl + dr);
  stated.twist[1] += 0.5 * (dr - dl) / track;
  stated.twist[2] += (dl + dr) / (track * track);
}

}  // namespace sf::record
