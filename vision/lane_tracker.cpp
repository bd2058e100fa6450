#include "vision/lane_tracker.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/matrix.hpp>

#include "base/elementary.h"

namespace sf::vision {

namespace {

// Lengths are those of scale 1, lanes of about 0.5 m.
// Errors of points along an edge are not independent, so each has a part of the information that it would have alone.
constexpr double kPointSigma = 0.02;  // [m] at the robot, and twice as much at kTwice
constexpr double kTwice = 0.6;        // [m]
constexpr double kLaneGate = 0.2;     // of the lane's width: points farther from an edge have no weight
constexpr int kIterations = 4;
constexpr double kLeastEdge = 0.1;  // [m] of an edge in one image, to see a lane; twice as much to find one
// Growth of the standard deviations over one metre: offset [m], heading [rad], curvature [1/m], width [m].
constexpr std::array<double, 4> kGrowth{0.02, 0.05, 0.6, 0.01};
constexpr std::array<double, 4> kFirst{0.05, 0.1, 0.4, 0.03};  // standard deviations of a lane that was found

/// Distance of a point from the lane's middle, and its derivatives by offset, heading, curvature, width.
struct EdgeDistance {
  double left;
  glm::dvec4 slope;
};

// In the frame of the lane's middle beside the robot, the point is (u, v). With q = u^2 + v^2 and the curvature k, its
// distance from the arc's centre is S / |k|, S = sqrt(1 - 2 k v + k^2 q), and from the arc (1 - S) / k, written so that
// k may be 0.
EdgeDistance side_of(const Lane& lane, glm::dvec2 p) {
  const auto [s, c] = base::sin_cos(lane.heading);
  const double u = c * p.x - s * p.y, v = lane.offset + s * p.x + c * p.y, q = u * u + v * v, k = lane.curvature;
  const double S = std::sqrt(std::max(1e-6, 1.0 - 2.0 * k * v + k * k * q)), n = 2.0 * v - k * q;
  const double by_u = -k * u / S, by_v = (1.0 - k * v) / S;
  const double by_k = -(q * (1.0 + S) + n * (k * q - v) / S) / ((1.0 + S) * (1.0 + S));
  const double du = -s * p.x - c * p.y, dv = c * p.x - s * p.y;  // by heading
  return {n / (1.0 + S), {by_v, by_u * du + by_v * dv, by_k, 0.0}};
}

/// A point's weight by its distance from the edge, 0 from `gate` on (Tukey's biweight).
double edge_weight(double residual, double gate) {
  const double x = residual / gate, y = std::max(0.0, 1.0 - x * x);
  return y * y;
}

/// @param sigmas at scale 1 @param factor of their squares
glm::dmat4 lane_variances(const std::array<double, 4>& sigmas, double factor, double scale) {
  const std::array<double, 4> units{scale, 1.0, 1.0 / scale, scale};
  glm::dmat4 m(0.0);
  for (int i = 0; i < 4; ++i) {
    const double sigma = units[static_cast<std::size_t>(i)] * sigmas[static_cast<std::size_t>(i)];
    m[i][i] = factor * sigma * sigma;
  }
  return m;
}

constexpr int kBins = 240;

/// Lengths of paint by the distance from an arc through the robot.
struct Histogram {
  std::array<int, kBins> points{};
  double bin = 0.0;  ///< [m]

  double left_of(int i) const { return (i + 0.5 - 0.5 * kBins) * bin; }
  int at(int i) const { return i < 0 || i >= kBins ? 0 : points[static_cast<std::size_t>(i)]; }
  int around(int i) const { return at(i - 2) + at(i - 1) + at(i) + at(i + 1) + at(i + 2); }
  int largest() const {
    int most = 0;
    for (int i = 0; i < kBins; ++i) most = std::max(most, around(i));
    return most;
  }
  long sharpness() const {
    long sum = 0;
    for (const int n : points) sum += long{n} * n;
    return sum;
  }
  /// Returns the first line from the robot on. @param step +1: to the left
  int edge(int step, int least) const {
    for (int i = kBins / 2 + (step < 0 ? -1 : 0); i >= 0 && i < kBins; i += step)
      if (around(i) >= least && around(i) >= around(i + step) && at(i) >= at(i + step)) return i;
    return -1;
  }
};

}  // namespace

double left_of_middle(const Lane& lane, glm::dvec2 p) { return side_of(lane, p).left; }

double LaneTracker::sigma() const { return std::sqrt(covariance_[0][0]); }

void LaneTracker::move(const base::Twist& twist, double seconds) {
  if (!has_lane_) return;
  const double way = twist.forward * seconds, turn = twist.turn * seconds;
  const auto [s, c] = base::sin_cos(lane_.heading + 0.5 * turn);
  const double along = 1.0 / std::max(0.1, 1.0 - lane_.curvature * lane_.offset);
  lane_.offset += way * s;
  lane_.heading += turn - way * c * along * lane_.curvature;
  glm::dmat4 F(1.0);  // columns: by offset, heading, curvature, width
  F[1][0] = way * c, F[2][1] = -way * c * along;
  covariance_ =
      F * covariance_ * glm::transpose(F) + lane_variances(kGrowth, std::abs(way) / limits_.scale, limits_.scale);
  if (sigma() > 0.25 * lane_.width) has_lane_ = false;
}

bool LaneTracker::update(std::span<const glm::dvec2> points) {
  return has_lane_ || search(points) ? correct(points) : false;
}

bool LaneTracker::search(std::span<const glm::dvec2> points) {
  const double scale = limits_.scale;
  Histogram best;
  Lane found;
  long sharpest = 0;
  for (int h = -10; h <= 10; ++h)
    for (int k = -6; k <= 6; ++k) {
      const Lane lane{0.0, 0.04 * h, k / 6.0 * limits_.sharpest / limits_.scale, 0.0};
      Histogram histogram{.bin = limits_.scale * limits_.widest / 80.0};
      for (const glm::dvec2& p : points) {
        const double at = left_of_middle(lane, p) / histogram.bin + 0.5 * kBins;
        if (at >= 0.0 && at < kBins) ++histogram.points[static_cast<std::size_t>(at)];
      }
      if (histogram.sharpness() <= sharpest) continue;
      sharpest = histogram.sharpness(), best = histogram, found = lane;
    }
  // An edge has a third of the length of the longest line, so that scattered points are none.
  const int least = std::max(static_cast<int>(2.0 * kLeastEdge * scale / limits_.row), best.largest() / 3);
  const int left = best.edge(1, least), right = best.edge(-1, least);
  if (left < 0 || right < 0) return false;
  found.offset = -0.5 * (best.left_of(left) + best.left_of(right));
  found.width = best.left_of(left) - best.left_of(right);
  if (!(found.width >= scale * limits_.narrowest && found.width <= scale * limits_.widest)) return false;
  lane_ = found, covariance_ = lane_variances(kFirst, 1.0, limits_.scale);
  return has_lane_ = true;
}

namespace {

/// The normal equations of a lane near an estimate, from the points of an image.
struct LaneEvidence {
  glm::dmat4 information{0.0};
  glm::dvec4 pull{};             ///< information times the difference from the estimate
  std::array<double, 2> seen{};  ///< [m] of the left and the right edge
};

LaneEvidence evidence_of(const Lane& lane, std::span<const glm::dvec2> points, const LaneLimits& limits) {
  LaneEvidence evidence;
  for (const glm::dvec2& p : points) {
    EdgeDistance from = side_of(lane, p);
    const bool is_left = from.left > 0.0;
    const double residual = (is_left ? 0.5 : -0.5) * lane.width - from.left;
    const double part = edge_weight(residual, kLaneGate * lane.width), far = p.x / (limits.scale * kTwice);
    const double sigma = limits.scale * kPointSigma * (1.0 + far * far), weight = part / (sigma * sigma);
    from.slope[3] = is_left ? -0.5 : 0.5;
    evidence.information += weight * glm::outerProduct(from.slope, from.slope);
    evidence.pull += weight * residual * from.slope;
    evidence.seen[is_left ? 0 : 1] += part * limits.row;
  }
  return evidence;
}

glm::dvec4 vector_of(const Lane& lane) { return {lane.offset, lane.heading, lane.curvature, lane.width}; }

}  // namespace

bool LaneTracker::correct(std::span<const glm::dvec2> points) {
  const glm::dmat4 prior = glm::inverse(covariance_);
  const double scale = limits_.scale, sharpest = limits_.sharpest / scale;
  Lane lane = lane_;
  glm::dmat4 covariance;
  for (int k = 0; k < kIterations; ++k) {
    const LaneEvidence evidence = evidence_of(lane, points, limits_);
    if (std::max(evidence.seen[0], evidence.seen[1]) < scale * kLeastEdge) return false;
    covariance = glm::inverse(prior + evidence.information);
    const glm::dvec4 next =
        vector_of(lane) + covariance * (evidence.pull + prior * (vector_of(lane_) - vector_of(lane)));
    lane = {next[0], next[1], std::clamp(next[2], -sharpest, sharpest),
            std::clamp(next[3], scale * limits_.narrowest, scale * limits_.widest)};
  }
  lane_ = lane, covariance_ = covariance;
  return true;
}

}  // namespace sf::vision
