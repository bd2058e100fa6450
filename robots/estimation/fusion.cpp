#include "robots/estimation/fusion.h"

#include <algorithm>

namespace sf::estimation {

namespace {

/// Inverse of a covariance, and the value multiplied by it.
struct Information {
  double xx = 0.0, xy = 0.0, yy = 0.0;
  glm::dvec2 weighted{};

  double determinant() const { return xx * yy - xy * xy; }
};

Information information_of(const Stated& stated) {
  constexpr double kLeast = kLeastSigma * kLeastSigma;
  const double xx = stated.covariance[0] + kLeast, xy = stated.covariance[1], yy = stated.covariance[2] + kLeast;
  const double determinant = xx * yy - xy * xy;
  const Information i{yy / determinant, -xy / determinant, xx / determinant};
  return {
      i.xx, i.xy, i.yy, {i.xx * stated.value.x + i.xy * stated.value.y, i.xy * stated.value.x + i.yy * stated.value.y}};
}

/// Returns share * a + (1 - share) * b.
Information mixed(const Information& a, const Information& b, double share) {
  const double rest = 1.0 - share;
  return {share * a.xx + rest * b.xx, share * a.xy + rest * b.xy, share * a.yy + rest * b.yy,
          share * a.weighted + rest * b.weighted};
}

Stated stated_of(const Information& i) {
  const double determinant = i.determinant();
  const std::array<double, 3> covariance{i.yy / determinant, -i.xy / determinant, i.xx / determinant};
  return {{covariance[0] * i.weighted.x + covariance[1] * i.weighted.y,
           covariance[1] * i.weighted.x + covariance[2] * i.weighted.y},
          covariance};
}

/// Returns the share of `a` with the largest determinant: the vertex of a parabola, or an end if it is convex.
double best_share(const Information& a, const Information& b) {
  const double at_0 = b.determinant(), at_1 = a.determinant(), at_half = mixed(a, b, 0.5).determinant();
  const double curvature = 2.0 * (at_0 + at_1 - 2.0 * at_half), slope = at_1 - at_0 - curvature;
  if (curvature < 0.0) return std::clamp(-slope / (2.0 * curvature), 0.0, 1.0);
  return at_1 > at_0 ? 1.0 : 0.0;
}

}  // namespace

Stated fuse_independent(std::span<const Stated> estimates) {
  Information sum;
  for (const Stated& stated : estimates) {
    const Information i = information_of(stated);
    sum.xx += i.xx, sum.xy += i.xy, sum.yy += i.yy, sum.weighted += i.weighted;
  }
  return stated_of(sum);
}

Stated fuse_correlated(std::span<const Stated> estimates) {
  Information fused = information_of(estimates.front());
  for (const Stated& stated : estimates.subspan(1)) {
    const Information next = information_of(stated);
    fused = mixed(fused, next, best_share(fused, next));
  }
  return stated_of(fused);
}

}  // namespace sf::estimation
