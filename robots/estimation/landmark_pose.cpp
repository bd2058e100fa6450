#include "robots/estimation/landmark_pose.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <cmath>

#include "base/elementary.h"
#include "robots/estimation/chi_square.h"

namespace sf::estimation {

namespace {

using Eigen::Matrix3d, Eigen::Vector2d, Eigen::Vector3d;

constexpr int kRounds = 5;  // Gauss-Newton, from a start that is exact without noise

Vector2d seen_at(const WheeledMeasurement& m) { return {m.values[0], m.values[1]}; }
Vector2d landmark_of(const WheeledMeasurement& m) { return {m.landmark[0], m.landmark[1]}; }

/// Least squares with weights by the variances, which has a closed form.
Vector3d first_pose(std::span<const WheeledMeasurement> sightings) {
  double sum = 0.0;
  Vector2d seen = Vector2d::Zero(), landmarks = Vector2d::Zero();
  const auto weight = [](const WheeledMeasurement& m) { return 1.0 / (m.covariance[0] + m.covariance[3]); };
  for (const WheeledMeasurement& m : sightings)
    sum += weight(m), seen += weight(m) * seen_at(m), landmarks += weight(m) * landmark_of(m);
  seen /= sum, landmarks /= sum;
  double along = 0.0, across = 0.0;
  for (const WheeledMeasurement& m : sightings) {
    const Vector2d a = seen_at(m) - seen, b = landmark_of(m) - landmarks;
    along += weight(m) * a.dot(b), across += weight(m) * (a.x() * b.y() - a.y() * b.x());
  }
  const double yaw = base::atan2(across, along);
  const auto [s, c] = base::sin_cos(yaw);
  return {landmarks.x() - c * seen.x() + s * seen.y(), landmarks.y() - s * seen.x() - c * seen.y(), yaw};
}

/// Normal equations of the residuals at a pose.
struct Normal {
  Matrix3d information = Matrix3d::Zero();
  Vector3d gradient = Vector3d::Zero();
  double squared = 0.0;  ///< sum of the squared residuals, in units of their covariance
};

Normal normal_at(std::span<const WheeledMeasurement> sightings, const Vector3d& pose) {
  Normal all;
  const auto [s, c] = base::sin_cos(pose.z());
  for (const WheeledMeasurement& m : sightings) {
    const Vector2d d = landmark_of(m) - pose.head<2>(), seen(c * d.x() + s * d.y(), c * d.y() - s * d.x());
    Eigen::Matrix<double, 2, 3> J;
    J << -c, -s, seen.y(), s, -c, -seen.x();
    const Eigen::Matrix2d covariance{{m.covariance[0], m.covariance[1]}, {m.covariance[1], m.covariance[3]}};
    const Eigen::Matrix2d information = covariance.inverse();
    const Vector2d residual = seen_at(m) - seen;
    all.information += J.transpose() * information * J;
    all.gradient += J.transpose() * information * residual;
    all.squared += residual.dot(information * residual);
  }
  return all;
}

}  // namespace

std::optional<WheeledMeasurement> pose_of(std::span<const WheeledMeasurement> sightings) {
  if (sightings.size() < 2) return std::nullopt;
  Vector3d pose = first_pose(sightings);
  for (int k = 0; k < kRounds; ++k) {
    const Normal at = normal_at(sightings, pose);
    pose += at.information.inverse() * at.gradient;
  }
  const Normal at = normal_at(sightings, pose);
  const Matrix3d P = at.information.inverse();
  const int degrees = 2 * static_cast<int>(sightings.size()) - 3;
  // `!(a <= b)` rejects NaN as well.
  if (!(at.squared <= chi_square_limit(degrees, kSightingsGate))) return std::nullopt;
  if (!(P(2, 2) > 0.0 && P(2, 2) <= kMostHeadingSigma * kMostHeadingSigma)) return std::nullopt;
  const WheeledMeasurement measured{.time = sightings[0].time,
                                    .values = {pose.x(), pose.y(), base::wrap_angle(pose.z())},
                                    .covariance = {P(0, 0), P(0, 1), P(0, 2), P(1, 1), P(1, 2), P(2, 2)}};
  return is_valid(measured) ? std::optional(measured) : std::nullopt;
}

}  // namespace sf::estimation
