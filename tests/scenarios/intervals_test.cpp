#include "scenarios/intervals.h"

#include <gtest/gtest.h>

#include <array>
#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <vector>

namespace sf::scenarios {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(Intervals, QuantilesMatchBoost) {
  for (std::size_t freedom = 1; freedom < 100'000; freedom = freedom < 40 ? freedom + 1 : freedom * 3) {
    const double exact = boost::math::quantile(boost::math::students_t(static_cast<double>(freedom)), 0.975);
    EXPECT_NEAR(student_quantile(freedom) / exact, 1.0, 1e-10) << freedom;
  }
  EXPECT_NEAR(student_quantile(2'000'000), 1.959964, 3e-5) << "as of the normal distribution";
}

/// Tables of Student's t: 12.706, 4.303, 3.182, 2.776 for 1 to 4 degrees of freedom.
TEST(Intervals, MeansHaveStudentsInterval) {
  const std::array<double, 3> values{1.0, 2.0, 6.0};  // mean 3, deviation sqrt(7), t 4.302653
  const Interval interval = mean_interval(values);
  EXPECT_EQ(interval.count, 3u);
  EXPECT_EQ(interval.mean, 3.0);
  EXPECT_NEAR(interval.high - 3.0, 4.302652729749464 * std::sqrt(7.0 / 3.0), 1e-9);
  EXPECT_NEAR(3.0 - interval.low, interval.high - 3.0, 1e-12);
}

TEST(Intervals, LimitCasesOfMeans) {
  const Interval none = mean_interval({});
  EXPECT_EQ(none.count, 0u);
  EXPECT_TRUE(std::isnan(none.mean) && std::isnan(none.low));
  const std::array<double, 1> one{5.0};
  EXPECT_EQ(mean_interval(one).mean, 5.0);
  EXPECT_TRUE(std::isnan(mean_interval(one).low)) << "a single value has no interval";
  const std::array<double, 4> odd{2.0, kNan, HUGE_VAL, 2.0};
  EXPECT_EQ(mean_interval(odd).count, 2u) << "non-finite values are left out";
  EXPECT_EQ(mean_interval(odd).low, 2.0) << "equal values have an interval of no length";
}

/// At the ends of Wilson's interval, the score test is at its limit: (p - end)^2 = z^2 end (1 - end) / n.
TEST(Intervals, ProportionsHaveWilsonsInterval) {
  constexpr double z = 1.959963984540054;
  for (const std::size_t n : {1u, 2u, 3u, 10u, 1000u})
    for (const std::size_t hits : {std::size_t{0}, n / 3, n / 2, n - 1, n}) {
      const Interval interval = proportion_interval(hits, n);
      const double p = static_cast<double>(hits) / static_cast<double>(n);
      EXPECT_EQ(interval.mean, p);
      EXPECT_LE(interval.low, p);
      EXPECT_GE(interval.high, p);
      EXPECT_GE(interval.low, 0.0);
      EXPECT_LE(interval.high, 1.0);
      for (const double end : {interval.low, interval.high})
        EXPECT_NEAR((p - end) * (p - end), z * z * end * (1.0 - end) / static_cast<double>(n), 1e-12)
            << hits << "/" << n;
    }
  // The exact interval (Clopper and Pearson) is wider.
  using boost::math::binomial_distribution;
  const Interval half = proportion_interval(5, 10);
  EXPECT_GT(half.low, binomial_distribution<>::find_lower_bound_on_p(10, 5, 0.025));
  EXPECT_LT(half.high, binomial_distribution<>::find_upper_bound_on_p(10, 5, 0.025));
  EXPECT_TRUE(std::isnan(proportion_interval(0, 0).mean)) << "undefined without samples";
}

TEST(Intervals, DoneIsAProportion) {
  const std::vector<double> values{1.0, 0.0, 1.0, kNan};
  EXPECT_EQ(metric_interval("done", values).high, proportion_interval(2, 3).high);
  EXPECT_EQ(metric_interval("distance", values).high, mean_interval(values).high);
}

}  // namespace
}  // namespace sf::scenarios
