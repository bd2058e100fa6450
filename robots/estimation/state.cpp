#include "robots/estimation/state.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <tuple>

namespace sf::estimation {

namespace {

using Numbers = std::array<double, 16>;

Numbers numbers_of(const Measurement& m) {
  Numbers all{m.X_WM.x, m.X_WM.y, m.X_WM.z, m.X_WM.yaw, m.velocity.forward, m.velocity.left, m.velocity.turn};
  std::copy(m.twist_variance.begin(), m.twist_variance.end(),
            std::copy(m.pose_covariance.begin(), m.pose_covariance.end(), all.begin() + 7));
  return all;
}

constexpr double kMostState = 1e9;
constexpr double kLeastStateVariance = 1e-18;
constexpr double kMostVariance = 1e18;

bool is_variance(double v) { return v >= kLeastStateVariance && v <= kMostVariance; }

/// Sylvester's criterion on correlations, so that units do not matter. Rejects correlations of 1 - 1e-9 and above.
bool is_positive_definite(const std::array<double, 6>& c) {
  if (!is_variance(c[0]) || !is_variance(c[3]) || !is_variance(c[5])) return false;
  const double xy = c[1] / std::sqrt(c[0] * c[3]);
  const double x_yaw = c[2] / std::sqrt(c[0] * c[5]);
  const double y_yaw = c[4] / std::sqrt(c[3] * c[5]);
  constexpr double kLeast = 2e-9;
  return 1.0 - xy * xy > kLeast &&
         1.0 - xy * xy - x_yaw * x_yaw - y_yaw * y_yaw + 2.0 * xy * x_yaw * y_yaw > kLeast * (1.0 - xy * xy);
}

}  // namespace

std::strong_ordering operator<=>(const Measurement& a, const Measurement& b) {
  const auto key = [](const Measurement& m) { return std::tuple(m.time, m.source, m.sequence, m.components); };
  if (const auto order = key(a) <=> key(b); order != 0) return order;
  using Bits = std::array<std::uint64_t, std::tuple_size_v<Numbers>>;
  return std::bit_cast<Bits>(numbers_of(a)) <=> std::bit_cast<Bits>(numbers_of(b));
}

PoseCovariance moved(const PoseCovariance& c, const glm::dvec2& arm) {
  // The other point is at p + arm, and the arm turns by (-arm.y, arm.x) per radian.
  const glm::dvec2 d{-arm.y, arm.x};
  return {c[0] + 2.0 * d.x * c[2] + d.x * d.x * c[5],
          c[1] + d.y * c[2] + d.x * c[4] + d.x * d.y * c[5],
          c[2] + d.x * c[5],
          c[3] + 2.0 * d.y * c[4] + d.y * d.y * c[5],
          c[4] + d.y * c[5],
          c[5]};
}

std::optional<PoseCovariance> stated_covariance(const std::array<float, 6>& stated) {
  constexpr double kLeast = 1e-8;
  PoseCovariance c;
  std::copy(stated.begin(), stated.end(), c.begin());
  if (!is_positive_definite(c)) return std::nullopt;
  for (const std::size_t k : {0u, 3u, 5u}) c[k] = std::max(c[k], kLeast);
  return c;
}

bool is_valid(const Measurement& m) {
  constexpr std::int64_t kMaxTime = std::int64_t{1} << 62;
  if (m.time < 0 || m.time > kMaxTime || m.components == 0 || m.components >= 1u << kComponents) return false;
  const Numbers all = numbers_of(m);
  return std::all_of(all.begin(), all.begin() + 7, [](double v) { return std::abs(v) <= kMostState; }) &&
         std::all_of(m.twist_variance.begin(), m.twist_variance.end(), is_variance) &&
         is_positive_definite(m.pose_covariance);
}

}  // namespace sf::estimation
