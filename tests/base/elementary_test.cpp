// Elementary functions: their errors against 50 digits, their ends, and their bytes.

#include "base/elementary.h"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>

#include "base/hash.h"
#include "base/random.h"

namespace sf::base {
namespace {

using Digits50 = boost::multiprecision::cpp_bin_float_50;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

double unit(std::uint32_t i) { return random_uniform({.seed = 5, .stream = RandomStream::decision}, i)[0]; }

/// Returns the error of `got` in units in the last place of `exact`.
double ulps(double got, const Digits50& exact) {
  int exponent = 0;
  std::frexp(static_cast<double>(exact), &exponent);
  return static_cast<double>(abs(exact - got) / ldexp(Digits50(1), std::max(exponent, -1021) - 53));
}

/// Returns the largest error of `function` at arguments between `low` and `high`, or at their exponentials.
template <class Function, class Exact>
double worst(Function function, Exact exact, double low, double high, bool of_exponents = false) {
  double most = 0.0;
  for (std::uint32_t i = 0; i < 3'000; ++i) {
    double x = low + (high - low) * unit(i);
    if (of_exponents) x = std::exp2(x);
    most = std::max(most, ulps(function(x), exact(Digits50(x))));
  }
  return most;
}

TEST(Elementary, AnglesAreWithinTheirErrors) {
  for (const double top : {1e-3, 0.78, 3.2, 100.0}) {
    const auto tangent = [](const Digits50& x) -> Digits50 { return tan(x); };
    EXPECT_LT(worst([](double x) { return sin(x); }, [](const Digits50& x) -> Digits50 { return sin(x); }, -top, top),
              0.9);
    EXPECT_LT(worst([](double x) { return cos(x); }, [](const Digits50& x) -> Digits50 { return cos(x); }, -top, top),
              0.9);
    EXPECT_LT(worst([](double x) { return tan(x); }, tangent, -top, top), 2.5) << top;
  }
}

TEST(Elementary, LargeAnglesAreWithinAnAbsoluteError) {
  for (const double top : {1e5, 1e6, 1.1e6, 1e9, 1e12})
    for (std::uint32_t i = 0; i < 300; ++i) {
      const double x = top * (2.0 * unit(i) - 1.0);
      EXPECT_LT(abs(Digits50(sin(x)) - sin(Digits50(x))), 4e-16) << x;
      EXPECT_LT(abs(Digits50(cos(x)) - cos(Digits50(x))), 4e-16) << x;
    }
}

TEST(Elementary, ArcsAreWithinTheirErrors) {
  const auto arc = [](const Digits50& x) -> Digits50 { return atan(x); };
  EXPECT_LT(worst([](double x) { return atan(x); }, arc, -60.0, 60.0, true), 2.0);
  EXPECT_LT(worst([](double x) { return atan(x); }, arc, -3.0, 3.0), 2.0);
  const auto behind = [](const Digits50& x) -> Digits50 { return atan2(x, Digits50(-0.7)); };
  EXPECT_LT(worst([](double x) { return atan2(x, -0.7); }, behind, -3.0, 3.0), 1.5);
  EXPECT_LT(worst([](double x) { return asin(x); }, [](const Digits50& x) -> Digits50 { return asin(x); }, -1.0, 1.0),
            3.0);
  EXPECT_LT(worst([](double x) { return acos(x); }, [](const Digits50& x) -> Digits50 { return acos(x); }, -1.0, 1.0),
            3.0);
}

TEST(Elementary, ExponentialsAndRootsAreWithinTheirErrors) {
  const auto power = [](const Digits50& x) -> Digits50 { return exp(x); };
  EXPECT_LT(worst([](double x) { return exp(x); }, power, -1.0, 1.0), 1.1);
  EXPECT_LT(worst([](double x) { return exp(x); }, power, -745.0, 709.0), 1.1);
  const auto logarithm = [](const Digits50& x) -> Digits50 { return log(x); };
  EXPECT_LT(worst([](double x) { return log(x); }, logarithm, 0.0, 2.0), 1.0);
  EXPECT_LT(worst([](double x) { return log(x); }, logarithm, -1070.0, 1020.0, true), 1.0);
  const auto distance = [](const Digits50& x) -> Digits50 { return sqrt(x * x + Digits50(0.7) * 0.7); };
  EXPECT_LT(worst([](double x) { return hypot(x, 0.7); }, distance, -3.0, 3.0), 1.1);
  for (double x = -6.0; x < 26.0; x += 0.01) EXPECT_NEAR(erfc(x), std::erfc(x), 1e-15 + 2e-13 * std::erfc(x)) << x;
}

TEST(Elementary, ZerosAndEnds) {
  EXPECT_EQ(sin(0.0), 0.0);
  EXPECT_EQ(cos(0.0), 1.0);
  EXPECT_EQ(atan2(0.0, 0.0), 0.0) << "a bearing of no direction";
  EXPECT_EQ(atan2(-0.0, -1.0), -M_PI) << "from below";
  EXPECT_EQ(atan2(0.0, -1.0), M_PI);
  EXPECT_EQ(atan2(HUGE_VAL, HUGE_VAL), M_PI / 4) << "as in C";
  EXPECT_EQ(atan2(-HUGE_VAL, 1.0), -M_PI / 2);
  EXPECT_EQ(asin(1.0), M_PI / 2);
  EXPECT_EQ(acos(-1.0), M_PI);
  EXPECT_EQ(exp(0.0), 1.0);
  EXPECT_EQ(exp(-HUGE_VAL), 0.0);
  EXPECT_EQ(exp(710.0), HUGE_VAL) << "too large for a double";
  EXPECT_EQ(exp(-746.0), 0.0) << "too small";
  EXPECT_GT(exp(-745.0), 0.0) << "the smallest double";
  EXPECT_EQ(log(1.0), 0.0);
  EXPECT_EQ(log(0.0), -HUGE_VAL);
  EXPECT_EQ(log(HUGE_VAL), HUGE_VAL);
  EXPECT_EQ(hypot(3.0, -4.0), 5.0);
  EXPECT_EQ(erfc(-HUGE_VAL), 2.0);
  EXPECT_EQ(erfc(HUGE_VAL), 0.0);
}

TEST(Elementary, NotANumberWhereThereIsNoValue) {
  for (const double x : {sin(HUGE_VAL), cos(-HUGE_VAL), tan(kNan), sin(kNan), atan2(kNan, 1.0), atan2(1.0, kNan),
                         asin(1.1), acos(-1.1), exp(kNan), log(-1.0), log(kNan), hypot(kNan, 1.0), erfc(kNan)})
    EXPECT_TRUE(std::isnan(x)) << x;
}

TEST(Elementary, SymmetriesAreExact) {
  for (std::uint32_t i = 0; i < 10'000; ++i) {
    const double x = 20.0 * unit(i);
    EXPECT_EQ(sin(-x), -sin(x));
    EXPECT_EQ(cos(-x), cos(x));
    EXPECT_EQ(atan2(-x, 3.0), -atan2(x, 3.0));
    EXPECT_EQ(hypot(x, 3.0), hypot(-3.0, x));
  }
}

/// The one property that only a record can express: the bytes are the same on every processor and with every C library.
TEST(Elementary, BytesAreTheSameEverywhere) {
  std::vector<double> values;
  for (std::uint32_t i = 0; i < 100'000; ++i) {
    const double x = 8.0 * unit(i) - 4.0, y = 8.0 * unit(100'000 + i) - 4.0;
    for (const double value : {sin(x), cos(x), tan(x), atan2(x, y), asin(0.25 * x), acos(0.25 * x), exp(x),
                               log(std::abs(x)), hypot(x, y), erfc(x)})
      values.push_back(value);
  }
  EXPECT_EQ(hash_bytes(values.data(), sizeof(double) * values.size()), 0x73bc4ec3c1842cfau);
}

}  // namespace
}  // namespace sf::base
