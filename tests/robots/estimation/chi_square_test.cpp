#include "robots/estimation/chi_square.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sf::estimation {
namespace {

// Abramowitz and Stegun, table 26.8, with digits from newer tables.
TEST(ChiSquare, LimitsMatchTables) {
  EXPECT_NEAR(chi_square_limit(1, 0.05), 3.841458820694124, 1e-9);
  EXPECT_NEAR(chi_square_limit(3, 0.01), 11.344866730144373, 1e-9);
  EXPECT_NEAR(chi_square_limit(5, 0.95), 1.145476226061769, 1e-9);
  EXPECT_NEAR(chi_square_limit(6, 0.01), 16.811893829770927, 1e-9);
  EXPECT_NEAR(chi_square_limit(100, 0.5), 99.33412923598846, 1e-8);
}

TEST(ChiSquare, TwoDegreesMatchTheExponentialDistribution) {
  for (const double p : {1e-12, 1e-4, 0.3, 0.999999}) EXPECT_NEAR(chi_square_limit(2, p), -2.0 * std::log(p), 1e-9);
}

TEST(ChiSquare, ManyDegreesApproachTheNormalDistribution) {
  // Wilson and Hilferty: at 5000 degrees of freedom the approximation is accurate to 1e-3.
  const double n = 5000.0;
  const double z = 3.0902323061678132;  // tail 0.001
  const double expected = n * std::pow(1.0 - 2.0 / (9.0 * n) + z * std::sqrt(2.0 / (9.0 * n)), 3);
  EXPECT_NEAR(chi_square_limit(5000, 0.001), expected, 1e-2);
}

TEST(ChiSquare, TailFallsFromOneToZero) {
  EXPECT_EQ(chi_square_tail(3, 0.0), 1.0);
  EXPECT_EQ(chi_square_tail(3, -1.0), 1.0);  // below the support
  EXPECT_EQ(chi_square_tail(6, 1e6), 0.0);   // underflow
  EXPECT_NEAR(chi_square_tail(6, 1e-9), 1.0, 1e-15);
}

}  // namespace
}  // namespace sf::estimation
