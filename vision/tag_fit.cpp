#include "vision/tag_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/elementary.h"
#include "vision/median.h"
#include "vision/normal_equations.h"

namespace sf::vision {

namespace {

constexpr int kRounds = 6;

/// Outward normals of the sides in the tag's frame, as angles: up, right, down, left.
constexpr std::array<double, 4> kNormals{M_PI / 2.0, 0.0, -M_PI / 2.0, M_PI};

struct PlanePoint {
  glm::dvec2 p;  ///< [m]
  std::size_t side = 0;
  bool used = true;
};

/// The unknowns of the fit: position, heading, and half of the side.
struct Square {
  glm::dvec2 center;
  double yaw = 0.0;
  double half = 0.0;
};

/// [m] Distance outward from the side of the square.
double distance(const Square& square, const PlanePoint& point) {
  const double angle = square.yaw + kNormals[point.side];
  return glm::dot(base::direction(angle), point.p - square.center) - square.half;
}

/// Performs one Gauss-Newton step, in units of half the square's side so that all unknowns have similar magnitudes.
bool improve(Square& square, std::span<const PlanePoint> points) {
  SquareMatrix<4> normal{};
  std::array<double, 4> right{};
  for (const PlanePoint& point : points) {
    if (!point.used) continue;
    const double angle = square.yaw + kNormals[point.side];
    const glm::dvec2 n = base::direction(angle);
    const glm::dvec2 r = (point.p - square.center) / square.half;
    const std::array<double, 4> row{n.x, n.y, -base::cross(n, r), 1.0};
    const double error = glm::dot(n, r) - 1.0;
    for (std::size_t i = 0; i < 4; ++i) {
      right[i] += row[i] * error;
      for (std::size_t k = 0; k <= i; ++k) normal[i][k] += row[i] * row[k];
    }
  }
  if (!solve(normal, right)) return false;
  square.center += square.half * glm::dvec2{right[0], right[1]};
  square.yaw += right[2];
  square.half *= 1.0 + right[3];
  return square.half > 0.0 && std::isfinite(square.yaw);
}

/// Removes points far from the square.
void reject_outliers(const Square& square, std::vector<PlanePoint>& points, double pixel) {
  std::vector<double> distances;
  for (const PlanePoint& point : points) distances.push_back(std::abs(distance(square, point)));
  std::vector<double> sorted = distances;
  const double most = std::max(3.0 * 1.4826 * median(sorted), 0.05 * pixel);
  for (std::size_t i = 0; i < points.size(); ++i) points[i].used = distances[i] <= most;
}

/// Returns the square whose sides run through the means of the points of each side.
std::optional<Square> first_guess(std::span<const PlanePoint> points) {
  std::array<glm::dvec2, 4> mean{};
  std::array<double, 4> count{};
  for (const PlanePoint& point : points) {
    mean[point.side] += point.p;
    count[point.side] += 1.0;
  }
  if (std::count_if(count.begin(), count.end(), [](double n) { return n >= 3.0; }) < 3) return std::nullopt;
  for (std::size_t i = 0; i < 4; ++i) mean[i] /= std::max(1.0, count[i]);
  // Two opposite sides with points give the centre and one axis.
  const bool upright = count[0] >= 3.0 && count[2] >= 3.0;
  const glm::dvec2 axis = upright ? mean[0] - mean[2] : mean[1] - mean[3];
  const glm::dvec2 center = 0.5 * (upright ? mean[0] + mean[2] : mean[1] + mean[3]);
  const double yaw = base::atan2(axis.y, axis.x) - (upright ? M_PI / 2.0 : 0.0);
  const double half = 0.5 * glm::length(axis);
  if (!(half > 0.0)) return std::nullopt;
  return Square{center, yaw, half};
}

}  // namespace

std::optional<TagFit> fit_tag(const Camera& camera, std::span<const EdgePoint> points, double height) {
  std::vector<PlanePoint> on_plane;
  on_plane.reserve(points.size());
  for (const EdgePoint& point : points) {
    const auto p = to_plane(camera, point.pixel, height);
    if (p) on_plane.push_back({*p, static_cast<std::size_t>(point.side)});
  }
  auto square = first_guess(on_plane);
  if (!square) return std::nullopt;

  // Size of a pixel, from the area of one.
  const auto middle = project(camera, {square->center.x, square->center.y, height});
  if (!middle) return std::nullopt;
  const auto p0 = to_plane(camera, *middle, height), pu = to_plane(camera, *middle + glm::dvec2{1.0, 0.0}, height),
             pv = to_plane(camera, *middle + glm::dvec2{0.0, 1.0}, height);
  if (!p0 || !pu || !pv) return std::nullopt;
  const double pixel = std::sqrt(std::abs(base::cross(*pu - *p0, *pv - *p0)));

  for (int round = 0; round < kRounds; ++round) {
    if (!improve(*square, on_plane)) return std::nullopt;
    if (round >= 2 && round < kRounds - 1) reject_outliers(*square, on_plane, pixel);
  }
  double squares = 0.0, used = 0.0;
  for (const PlanePoint& point : on_plane) {
    if (!point.used) continue;
    squares += std::pow(distance(*square, point), 2);
    used += 1.0;
  }
  return TagFit{{square->center.x, square->center.y, height, base::wrap_angle(square->yaw)},
                2.0 * square->half,
                std::sqrt(squares / std::max(1.0, used)),
                pixel,
                middle->y,
                static_cast<int>(used)};
}

TagFit at_measured_height(const Camera& camera, const TagFit& flat, double side) {
  // The rays to the square are those of a similar one, scaled from the camera.
  const double scale = side / flat.side, depth = scale * (camera.position.z - flat.X_WT.z);
  const glm::dvec2 eye{camera.position.x, camera.position.y};
  const glm::dvec2 p = eye + scale * (glm::dvec2{flat.X_WT.x, flat.X_WT.y} - eye);
  TagFit fit = flat;
  fit.X_WT = {p.x, p.y, camera.position.z - depth, flat.X_WT.yaw};
  fit.side = side;
  fit.residual *= scale;
  fit.pixel *= scale;
  const double noise = 2.0 * fit.residual / std::sqrt(std::max(1, fit.points));
  fit.height_sigma = std::abs(depth) / side * base::hypot(noise, 2.0 * kEdgeBias * fit.pixel);
  return fit;
}

}  // namespace sf::vision
