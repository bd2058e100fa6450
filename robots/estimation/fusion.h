#pragma once
// Fusion of several estimates of one quantity with two components.

#include <array>
#include <span>

#include <glm/ext/vector_double2.hpp>

namespace sf::estimation {

/// An estimate with its covariance: xx, xy, yy. A quantity with one component has y 0, xy 0 and yy 1 in each estimate.
struct Stated {
  glm::dvec2 value{};
  std::array<double, 3> covariance{1.0, 0.0, 1.0};  ///< positive semidefinite
};

/// Its square is added to variances, so that exact estimates have a finite weight. [unit of the quantity]
inline constexpr double kLeastSigma = 1e-6;

/// Returns the estimate with the least variance if the errors are independent: each estimate weighs as the inverse of
/// its covariance. @pre at least one estimate
Stated fuse_independent(std::span<const Stated> estimates);

/// Covariance intersection (Julier, Uhlmann, "A non-divergent estimation algorithm in the presence of unknown
/// correlations", American Control Conference 1997), one estimate after the other, with the weights of the smallest
/// determinant: the covariance is never too small, whatever the correlation of the errors. With one component it is the
/// estimate with the smallest variance. @pre at least one estimate
Stated fuse_correlated(std::span<const Stated> estimates);

}  // namespace sf::estimation
