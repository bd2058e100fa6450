// Fits a tag's position and orientation in space.

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <utility>
#include <vector>

#include "base/elementary.h"
#include "vision/median.h"
#include "vision/normal_equations.h"
#include "vision/tag_fit.h"

namespace sf::vision {

namespace {

constexpr int kSteps = 30;
/// [rad] A start on the wrong side may end in a local minimum.
constexpr std::array<glm::dvec3, 5> kStarts{
    {{0.0, 0.0, 0.0}, {0.35, 0.0, 0.0}, {-0.35, 0.0, 0.0}, {0.0, 0.35, 0.0}, {0.0, -0.35, 0.0}}};
constexpr double kMinTiltSigma = 1e-6;  // [rad] of synthetic images without noise; 0 is reserved
constexpr double kDecided = 0.7;        // ratio of the sums of squares of two orientations that decides between them

/// A ray from the camera to an edge point.
struct EdgeRay {
  glm::dvec3 direction;
  glm::dvec2 outward;  ///< normal of the side in the tag's frame
};

/// A tag in space, and the mean square of its residuals.
struct SpaceFit {
  glm::dvec3 center;
  glm::dmat3 axes{1.0};  ///< R_WT
  double cost = HUGE_VAL;
  SquareMatrix<6> normal{};  ///< J^T J, in units of half the side and rad
};

/// Returns the rotation by |w| about w (Rodrigues).
glm::dmat3 rotation(glm::dvec3 w) {
  const double angle = glm::length(w);
  if (angle < 1e-15) return glm::dmat3(1.0);
  const glm::dvec3 n = w / angle;
  const auto [s, c] = base::sin_cos(angle);
  glm::dmat3 r(1.0);
  for (int i = 0; i < 3; ++i) {
    glm::dvec3 e;
    e[i] = 1.0;
    r[i] = c * e + s * glm::cross(n, e) + (1.0 - c) * n[i] * n;
  }
  return r;
}

class SpaceProblem {
 public:
  SpaceProblem(const Camera& camera, std::span<const EdgePoint> points, double side)
      : eye_(camera.position), half_(0.5 * side) {
    constexpr std::array<glm::dvec2, 4> kOutward{{{0.0, 1.0}, {1.0, 0.0}, {0.0, -1.0}, {-1.0, 0.0}}};
    for (const EdgePoint& point : points) {
      const glm::dvec2 n = undistort(camera.intrinsics, point.pixel);
      rays_.push_back(
          {n.x * camera.right + n.y * camera.down + camera.forward, kOutward[static_cast<std::size_t>(point.side)]});
    }
  }

  std::size_t size() const { return rays_.size(); }

  /// Minimises the residuals by Levenberg's and Marquardt's method.
  void minimise(SpaceFit& fit) const {
    fit.cost = cost_of(fit);
    double damping = 1e-6;
    for (int step = 0; step < kSteps && damping < 1e6; ++step) {
      std::array<double, 6> right{};
      linearise(fit, right);
      SquareMatrix<6> damped = fit.normal;
      for (std::size_t i = 0; i < 6; ++i) damped[i][i] *= 1.0 + damping;
      SpaceFit next = fit;
      if (!solve(damped, right)) return;
      move(next, right);
      next.cost = cost_of(next);
      const bool is_better = next.cost < fit.cost;
      const bool is_done = is_better && fit.cost - next.cost < 1e-9 * fit.cost;
      if (is_better) fit = next;
      damping *= is_better ? 0.1 : 10.0;
      if (is_done) break;
    }
    std::array<double, 6> ignored{};
    linearise(fit, ignored);
  }

  /// Removes points farther off than three standard deviations, by the median.
  void reject_outliers(const SpaceFit& fit, double pixel) {
    std::vector<double> distances;
    for (const EdgeRay& ray : rays_) distances.push_back(std::abs(half_ * residual(fit, ray)));
    std::vector<double> sorted = distances;
    const double most = std::max(3.0 * 1.4826 * median(sorted), 0.05 * pixel);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < rays_.size(); ++i)
      if (distances[i] <= most) rays_[kept++] = rays_[i];
    rays_.resize(kept);
  }

  /// [halves of the side] Returns the distance outward from the side at which the ray meets the tag's plane.
  double residual(const SpaceFit& fit, const EdgeRay& ray) const {
    const glm::dvec3 normal = fit.axes[2];
    const double along = glm::dot(normal, ray.direction);
    const double depth = glm::dot(normal, fit.center - eye_) / (std::abs(along) > 1e-9 ? along : 1e-9);
    const glm::dvec3 p = eye_ + depth * ray.direction - fit.center;
    return glm::dot(ray.outward, glm::dvec2{glm::dot(fit.axes[0], p), glm::dot(fit.axes[1], p)}) / half_ - 1.0;
  }

 private:
  double cost_of(const SpaceFit& fit) const {
    double sum = 0.0;
    for (const EdgeRay& ray : rays_) sum += std::pow(residual(fit, ray), 2);
    return sum / static_cast<double>(std::max<std::size_t>(1, rays_.size()));
  }
  /// @param step [halves of the side] of the centre, [rad] about the tag's axes
  void move(SpaceFit& fit, const std::array<double, 6>& step) const {
    fit.center += half_ * glm::dvec3{step[0], step[1], step[2]};
    fit.axes = fit.axes * rotation({step[3], step[4], step[5]});
  }
  /// Computes J^T J and -J^T r, with numerical derivatives.
  void linearise(SpaceFit& fit, std::array<double, 6>& right) const {
    constexpr double kDelta = 1e-6;
    std::array<SpaceFit, 6> ahead, behind;
    for (std::size_t i = 0; i < 6; ++i) {
      std::array<double, 6> step{};
      step[i] = kDelta;
      move(ahead[i] = fit, step);
      step[i] = -kDelta;
      move(behind[i] = fit, step);
    }
    fit.normal = {};
    for (const EdgeRay& ray : rays_) {
      std::array<double, 6> row{};
      for (std::size_t i = 0; i < 6; ++i)
        row[i] = (residual(ahead[i], ray) - residual(behind[i], ray)) / (2.0 * kDelta);
      const double error = residual(fit, ray);
      for (std::size_t i = 0; i < 6; ++i) {
        right[i] -= row[i] * error;
        for (std::size_t k = 0; k < 6; ++k) fit.normal[i][k] += row[i] * row[k];
      }
    }
  }

  glm::dvec3 eye_;
  double half_;
  std::vector<EdgeRay> rays_;
};

/// Returns the same tag with its normal mirrored at the line of sight `view`, a unit vector.
SpaceFit mirrored(const SpaceFit& fit, glm::dvec3 view) {
  const glm::dvec3 normal = fit.axes[2], other = 2.0 * glm::dot(normal, view) * view - normal;
  const glm::dvec3 axis = glm::cross(normal, other);
  const double sine = glm::length(axis);
  SpaceFit turned = fit;
  if (sine > 1e-12) turned.axes = rotation(base::atan2(sine, glm::dot(normal, other)) / sine * axis) * fit.axes;
  return turned;
}

/// [rad] Returns the angle between the normals of two tags.
double angle_between(const SpaceFit& a, const SpaceFit& b) {
  return base::atan2(glm::length(glm::cross(a.axes[2], b.axes[2])), glm::dot(a.axes[2], b.axes[2]));
}

}  // namespace

std::optional<TagFit> fit_tag_in_space(const Camera& camera, std::span<const EdgePoint> points, const TagFit& start,
                                       double side) {
  SpaceProblem problem(camera, points, side);
  TagFit fit = at_measured_height(camera, start, side);
  SpaceFit best;
  for (const glm::dvec3& tilt : kStarts) {
    SpaceFit from;
    from.center = {fit.X_WT.x, fit.X_WT.y, fit.X_WT.z};
    from.axes = rotation({0.0, 0.0, fit.X_WT.yaw}) * rotation(tilt);
    problem.minimise(from);
    if (from.cost < best.cost) best = from;
  }
  SpaceFit other = mirrored(best, glm::normalize(camera.position - best.center));
  problem.minimise(other);
  problem.reject_outliers(best.cost < other.cost ? best : other, fit.pixel);
  problem.minimise(best);
  problem.minimise(other);
  const bool is_open = std::min(best.cost, other.cost) > kDecided * std::max(best.cost, other.cost);
  const double between = is_open ? angle_between(best, other) : 0.0;
  if (is_open ? other.axes[2].z > best.axes[2].z : other.cost < best.cost) std::swap(best, other);

  // Variances: twice the residuals' divided by the curvature, since neighbouring edge points share pixels.
  const double spare = static_cast<double>(problem.size()) - 6.0;
  if (!(spare > 0.0) || !std::isfinite(best.cost) || !(best.axes[2].z > 0.0)) return std::nullopt;
  const double variance = 2.0 * best.cost * static_cast<double>(problem.size()) / spare;
  std::array<double, 6> sigma{};
  for (std::size_t i = 0; i < 6; ++i) {
    SquareMatrix<6> normal = best.normal;
    std::array<double, 6> unit{};
    unit[i] = 1.0;
    if (!solve(normal, unit)) return std::nullopt;
    sigma[i] = std::sqrt(variance * std::max(0.0, unit[i]));
  }
  const glm::dmat3& r = best.axes;
  fit.X_WT = {best.center.x, best.center.y, best.center.z, base::atan2(r[0].y, r[0].x)};
  fit.pitch = -base::asin(std::clamp(r[0].z, -1.0, 1.0));
  fit.roll = base::atan2(r[1].z, r[2].z);
  fit.residual = 0.5 * side * std::sqrt(best.cost);
  fit.points = static_cast<int>(problem.size());
  const double depth = glm::length(camera.position - best.center);
  fit.height_sigma = base::hypot(0.5 * side * sigma[2], 2.0 * kEdgeBias * fit.pixel * depth / side);
  fit.tilt_sigma = std::max({sigma[3], sigma[4], between, kMinTiltSigma});
  return fit;
}

}  // namespace sf::vision
