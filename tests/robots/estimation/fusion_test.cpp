#include "robots/estimation/fusion.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <vector>

namespace sf::estimation {
namespace {

/// A covariance from its standard deviations and correlation.
Stated stated(glm::dvec2 value, double x, double y, double correlation = 0.0) {
  return {value, {x * x, correlation * x * y, y * y}};
}

double determinant(const Stated& s) { return s.covariance[0] * s.covariance[2] - s.covariance[1] * s.covariance[1]; }

TEST(Fusion, IndependentEstimatesWeighAsTheInverseOfTheirVariance) {
  const std::vector<Stated> two{stated({0, 1}, 1, 1), stated({5, 1}, 2, 1)};
  const Stated fused = fuse_independent(two);
  EXPECT_NEAR(fused.value.x, 1.0, 1e-9);
  EXPECT_NEAR(fused.covariance[0], 0.8, 1e-9);
  EXPECT_NEAR(fused.covariance[2], 0.5, 1e-9);
}

/// Where one is better along x and the other along y, both count.
TEST(Fusion, IntersectionTakesEachAxisFromTheBetterEstimate) {
  const std::vector<Stated> two{stated({0, 3}, 0.1, 10), stated({4, 0}, 10, 0.1)};
  const Stated fused = fuse_correlated(two);
  EXPECT_NEAR(fused.value.x, 0.0, 1e-3);
  EXPECT_NEAR(fused.value.y, 0.0, 1e-3);
  EXPECT_NEAR(fused.covariance[0], 0.02, 1e-4) << "twice the better variance: half the weight";
}

TEST(Fusion, IntersectionOfOneComponentIsTheBetterEstimate) {
  const std::vector<Stated> two{{{1, 0}, {4, 0, 1}}, {{2, 0}, {0.25, 0, 1}}};
  EXPECT_NEAR(fuse_correlated(two).value.x, 2.0, 1e-9);
  EXPECT_NEAR(fuse_correlated(two).covariance[0], 0.25, 1e-9);
}

/// The same estimate twice is worth no more than once; independent fusion would halve its variance.
TEST(Fusion, IntersectionDoesNotCountOneEstimateTwice) {
  const std::vector<Stated> twice(2, stated({1, 2}, 0.5, 0.3, 0.4));
  EXPECT_NEAR(determinant(fuse_correlated(twice)), determinant(twice[0]), 1e-6);
  EXPECT_NEAR(determinant(fuse_independent(twice)), 0.25 * determinant(twice[0]), 1e-6);
}

TEST(Fusion, ExactEstimatesHaveAFiniteWeight) {
  const std::vector<Stated> two{stated({1, 1}, 0, 0), stated({2, 2}, 1, 1)};
  EXPECT_NEAR(fuse_independent(two).value.x, 1.0, 1e-9);
  EXPECT_NEAR(fuse_correlated(two).value.y, 1.0, 1e-9);
}

/// Over all correlations of two errors, the covariance of the intersection is at least that of its error.
RC_GTEST_PROP(Fusion, IntersectionIsConsistentForAnyCorrelation, ()) {
  const auto in = [](int least, int most) { return 0.01 * *rc::gen::inRange(least, most); };
  const Stated a = stated({}, in(10, 300), in(10, 300), in(-90, 90)),
               b = stated({}, in(10, 300), in(10, 300), in(-90, 90));
  // The fused error is linear in those of both: the weights are those of unit values.
  const auto weight = [&](bool first, glm::dvec2 unit) {
    Stated x = a, y = b;
    (first ? x : y).value = unit;
    return fuse_correlated(std::vector{x, y}).value;
  };
  const Stated fused = fuse_correlated(std::vector{a, b});
  const double correlation = in(-100, 100);
  for (const glm::dvec2& direction : std::vector<glm::dvec2>{{1, 0}, {0, 1}, {0.6, 0.8}, {0.8, -0.6}}) {
    // Along `direction`, the errors have the standard deviations `of_a` and `of_b`.
    const auto spread = [&](bool first, const Stated& s) {
      const glm::dvec2 to_x = weight(first, {1, 0}), to_y = weight(first, {0, 1});
      const double u = glm::dot(direction, to_x), v = glm::dot(direction, to_y);
      return std::sqrt(u * u * s.covariance[0] + 2 * u * v * s.covariance[1] + v * v * s.covariance[2]);
    };
    const double of_a = spread(true, a), of_b = spread(false, b);
    const double variance = of_a * of_a + of_b * of_b + 2 * correlation * of_a * of_b;
    const double claimed = direction.x * direction.x * fused.covariance[0] +
                           2 * direction.x * direction.y * fused.covariance[1] +
                           direction.y * direction.y * fused.covariance[2];
    RC_ASSERT(claimed >= variance * (1.0 - 1e-9));
  }
}

}  // namespace
}  // namespace sf::estimation
