#include "robots/estimation/kalman.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/time.h"
#include "tests/robots/estimation/reference.h"
#include "tests/units.h"

namespace sf::estimation {
namespace {

constexpr std::size_t at(int i, int j) { return static_cast<std::size_t>(6 * i + j); }

const MotionModel kWheels = differential_drive(0.2, 0.5);
const MotionModel kOmni{MotionModel::Path::arc, 0.2, 0.3, 0.5};
const MotionModel kBody = free_body(0.2, 0.5);

/// Has correlations between all components.
Estimate correlated(const base::Pose& X, const base::Twist& v, double scale = 1.0) {
  Estimate e{base::kSecond, X, v};
  const std::array<double, 6> sigma{0.1, 0.2, 0.05, 0.3, 0.1, 0.2};
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) e.covariance[at(i, j)] = scale * sigma[i] * sigma[j] * std::pow(-0.4, std::abs(i - j));
  return e;
}

/// Returns the largest difference of two covariances, relative to the standard deviations.
double covariance_error(const Estimate& e, const reference::Matrix& expected) {
  double error = 0.0;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) {
      const double scale = std::sqrt(expected[i][i] * expected[j][j]);
      if (scale > 0.0) error = std::max(error, std::abs(e.covariance[at(i, j)] - expected[i][j]) / scale);
    }
  return error;
}

/// Expects a symmetric, finite covariance without a negative variance in any direction of a pair of components.
void expect_covariance(const Estimate& e) {
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) {
      const double c = e.covariance[at(i, j)];
      ASSERT_TRUE(std::isfinite(c)) << i << ' ' << j;
      EXPECT_EQ(c, e.covariance[at(j, i)]);
      EXPECT_LE(std::abs(c), (1.0 + 1e-9) * std::sqrt(e.covariance[at(i, i)] * e.covariance[at(j, j)]) + 1e-30);
    }
}

void expect_state(const Estimate& e, const reference::Vector& expected, double tolerance) {
  const auto actual = reference::state_of(e);
  for (int i = 0; i < 6; ++i) {
    const double d = actual[i] - expected[i];
    EXPECT_NEAR(i == 2 ? base::wrap_angle(d) : d, 0.0, tolerance) << "component " << i;
  }
}

TEST(Predict, FollowsTheEquationsOfMotion) {
  for (const MotionModel& model : {kWheels, kOmni, kBody})
    for (const base::Twist& v : {base::Twist{0.5, 0.0, 0.0}, base::Twist{0.5, -0.2, 1.0}, base::Twist{-0.3, 0.1, -0.5},
                                 base::Twist{0.0, 0.0, 1.0}, base::Twist{}}) {
      const Estimate from = correlated({1.0, -2.0, 0.3, 3.0}, v);
      const Estimate to = predict(model, from, 2 * base::kSecond);
      const auto expected = reference::predict(model, from, 1.0);
      expect_state(to, expected.state, 1e-9);
      EXPECT_LT(covariance_error(to, expected.P), v.turn == 0.0 ? 1e-9 : 2e-3) << v.forward << ' ' << v.turn;
      EXPECT_EQ(to.X_WM.z, 0.3);
      EXPECT_EQ(to.time, 2 * base::kSecond);
    }
}

TEST(Predict, NoiseIsWithinOnePercent) {
  // Tests the bound stated in the header, without the initial covariance, which would hide it.
  for (const MotionModel& model : {kWheels, kOmni, kBody}) {
    const Estimate from{0, {0, 0, 0, 0.4}, {0.5, 0.0, 1.0}};
    const Estimate to = predict(model, from, base::kSecond);
    EXPECT_LT(covariance_error(to, reference::predict(model, from, 1.0).P), 0.01);
  }
}

TEST(Predict, TwoStepsEqualOne) {
  for (const MotionModel& model : {kWheels, kBody}) {
    const Estimate from = correlated({1, 2, 0, 1}, {0.5, 0.0, 0.7});
    const Estimate once = predict(model, from, base::kSecond + 400'000'000);
    const Estimate twice = predict(model, predict(model, from, base::kSecond + 150'000'000), once.time);
    expect_state(twice, reference::state_of(once), 1e-12);
    EXPECT_LT(covariance_error(twice, reference::covariance_of(once)), 1e-4);
  }
}

TEST(Predict, ZeroTimeIsBitwiseEqual) {
  const Estimate from = correlated({1, 2, 0, 1}, {0.5, 0.0, 0.7});
  const Estimate same = predict(kWheels, from, from.time);
  EXPECT_EQ(same.covariance, from.covariance);
  EXPECT_EQ(same.X_WM.x, from.X_WM.x);
}

TEST(Predict, BackwardsUndoesTheMotionAndAddsNoise) {
  const Estimate from = correlated({1, 2, 0, 1}, {0.5, 0.0, 0.7}, 1e-6);
  const Estimate there = predict(kWheels, from, 2 * base::kSecond);
  const Estimate back = predict(kWheels, there, from.time);
  expect_state(back, reference::state_of(from), 1e-12);
  EXPECT_GT(back.covariance[at(kX, kX)], there.covariance[at(kX, kX)]);
}

TEST(Predict, WheelsNeverMoveSideways) {
  Measurement m;
  m.velocity = {0.4, 0.3, 0.0};  // a camera's noise
  const Estimate first = first_estimate(kWheels, m);
  EXPECT_EQ(first.velocity.left, 0.0);
  const Estimate later = correct(predict(kWheels, first, base::kSecond), m);
  EXPECT_EQ(later.velocity.left, 0.0);
  EXPECT_EQ(later.covariance[at(kLeft, kLeft)], 0.0);
}

TEST(Correct, MatchesTheInformationForm) {
  const Estimate predicted = correlated({1.0, -2.0, 0.0, 0.5}, {0.5, -0.2, 1.0});
  Measurement m{.time = predicted.time, .X_WM = {1.2, -2.1, 0.7, 0.6}, .velocity = {0.4, -0.1, 0.8}};
  m.pose_covariance = {0.01, 0, 0, 0.02, 0, 0.003};
  m.twist_variance = {0.04, 0.05, 0.06};
  const Estimate corrected = correct(predicted, m);
  const auto expected = reference::correct(predicted, m);
  expect_state(corrected, expected.state, 1e-12);
  EXPECT_LT(covariance_error(corrected, expected.P), 1e-12);
  EXPECT_EQ(corrected.X_WM.z, 0.7);
}

TEST(Correct, ComponentsOneByOneMatchAllAtOnce) {
  const Estimate predicted = correlated({1.0, -2.0, 0.0, 0.5}, {0.5, -0.2, 1.0});
  Measurement all{.time = predicted.time, .X_WM = {1.2, -2.1, 0.0, 0.6}, .velocity = {0.4, -0.1, 0.8}};
  Estimate one_by_one = predicted;
  double squared = 0.0;
  for (int k = 0; k < 6; ++k) {
    Measurement one = all;
    one.components = static_cast<std::uint8_t>(1u << k);
    squared += innovation(one_by_one, one).squared;
    one_by_one = correct(one_by_one, one);
  }
  const Estimate at_once = correct(predicted, all);
  expect_state(one_by_one, reference::state_of(at_once), 1e-12);
  EXPECT_LT(covariance_error(one_by_one, reference::covariance_of(at_once)), 1e-12);
  EXPECT_NEAR(innovation(predicted, all).squared, squared, 1e-9 * squared);
  EXPECT_EQ(innovation(predicted, all).degrees, 6);
}

TEST(Correct, UsesCorrelationsOfTheMeasurement) {
  // A line of position at 45 degrees: accurate across it and uncertain along it.
  Estimate predicted{0, {}, {}};
  for (int i = 0; i < 6; ++i) predicted.covariance[at(i, i)] = 1.0;
  Measurement m{.components = kPositionBits, .X_WM = {2.0, 0.0, 0.0, 0.0}};
  m.pose_covariance = {5.0 + 1e-6, 5.0 - 1e-6, 0, 5.0 + 1e-6, 0, 1.0};
  const Estimate corrected = correct(predicted, m);
  // Across: x - y = 2 is certain. Along: x + y = 2 has variance 20, against 2 of the prediction.
  EXPECT_NEAR(corrected.X_WM.x - corrected.X_WM.y, 2.0, 1e-4);
  EXPECT_NEAR(corrected.X_WM.x + corrected.X_WM.y, 2.0 * 2.0 / 22.0, 1e-4);
}

TEST(Correct, YawTakesTheShorterWay) {
  Estimate predicted{0, {0, 0, 0, 3.1}, {}};
  for (int i = 0; i < 6; ++i) predicted.covariance[at(i, i)] = 1.0;
  for (const double turns : {0.0, 2.0 * M_PI, -1000.0 * M_PI}) {  // senders need not wrap
    Measurement m{.components = kPoseBits, .X_WM = {0, 0, 0, -3.1 + turns}};
    m.pose_covariance[5] = 1.0;
    EXPECT_NEAR(std::abs(correct(predicted, m).X_WM.yaw), M_PI, 1e-9);
    EXPECT_LT(innovation(predicted, m).squared, 0.01);
  }
}

TEST(Correct, PositionAloneKeepsTheHeight) {
  Estimate predicted{0, {0, 0, 0.5, 0}, {}};
  for (int i = 0; i < 6; ++i) predicted.covariance[at(i, i)] = 1.0;
  EXPECT_EQ(correct(predicted, {.components = 1u << kTurn, .X_WM = {0, 0, 9.0, 0}}).X_WM.z, 0.5);
}

TEST(FirstEstimate, UnmeasuredComponentsAreUnknown) {
  Measurement gps{.components = kPositionBits, .X_WM = {3.0, 4.0, 0.1, 1.0}, .velocity = {1, 1, 1}};
  gps.pose_covariance = {0.2, 0.1, 0.05, 0.3, 0.0, 1e-4};
  const Estimate e = first_estimate(kBody, gps);
  EXPECT_EQ(e.X_WM.x, 3.0);
  EXPECT_EQ(e.X_WM.yaw, 0.0);
  EXPECT_EQ(e.velocity.forward, 0.0);
  EXPECT_EQ(e.covariance[at(kX, kY)], 0.1);
  EXPECT_EQ(e.covariance[at(kX, kYaw)], 0.0);
  EXPECT_EQ(e.covariance[at(kYaw, kYaw)], M_PI * M_PI);
  EXPECT_EQ(e.covariance[at(kLeft, kLeft)], 1.0);
}

TEST(Extremes, DistanceFromTheOriginDoesNotMatter) {
  // The same run at the origin and far away differs only by the rounding of positions.
  for (const double away : {1e5, 1e7}) {
    Estimate near = correlated({0, 0, 0, 0.3}, {0.5, 0, 0.2});
    Estimate far = correlated({away, -away, 0, 0.3}, {0.5, 0, 0.2});
    for (int k = 1; k <= 1000; ++k) {
      near = predict(kWheels, near, near.time + 20'000'000);
      far = predict(kWheels, far, far.time + 20'000'000);
      Measurement m{.time = near.time, .X_WM = {0.01 * k, 0.001 * k, 0, 0.3}, .velocity = {0.5, 0, 0}};
      near = correct(near, m);
      m.X_WM.x += away;
      m.X_WM.y -= away;
      far = correct(far, m);
    }
    EXPECT_NEAR(far.X_WM.x - away, near.X_WM.x, 1e-14 * away);
    EXPECT_NEAR(far.X_WM.yaw, near.X_WM.yaw, 1e-13 * away);
    expect_covariance(far);
  }
}

TEST(Extremes, DayAtRestNeitherGrowsNorBreaks) {
  // The covariance reaches its fixed point after a hundred of the day's 1.3 million updates, sideways too.
  Estimate e = first_estimate(kWheels, {});
  for (int k = 1; k <= 50'000; ++k) e = correct(predict(kWheels, e, k * 66'666'667LL), {.time = k * 66'666'667LL});
  expect_covariance(e);
  EXPECT_EQ(e.X_WM.x, 0.0);
  EXPECT_EQ(e.velocity.turn, 0.0);
  const Estimate next = correct(predict(kWheels, e, e.time + 66'666'667), {.time = e.time + 66'666'667});
  EXPECT_LT(covariance_error(next, reference::covariance_of(e)), 1e-12);
}

TEST(Extremes, WithoutNoiseTheCovarianceStaysPositive) {
  // No process noise, exact measurements: the common short form P - K H P loses symmetry and sign here first.
  MotionModel still = differential_drive(0.0, 0.0);
  still.slip = 0.0;
  Measurement exact;
  exact.pose_covariance = {1e-16, 0, 0, 1e-16, 0, 1e-16};
  exact.twist_variance = {1e-16, 1e-16, 1e-16};
  Estimate e = correlated({}, {});
  for (int k = 1; k <= 10'000; ++k) {
    exact.time = e.time + 1'000'000;
    e = correct(predict(still, e, exact.time), exact);
    for (int i = 0; i < 6; ++i) ASSERT_GE(e.covariance[at(i, i)], 0.0) << k;
  }
  expect_covariance(e);
}

TEST(Extremes, TinyAndHugeTimes) {
  const Estimate from = correlated({1, 2, 0, 1}, {0.5, 0.0, 0.7});
  const Estimate tiny = predict(kWheels, from, from.time + 1);
  expect_state(tiny, reference::state_of(from), 1e-9);
  EXPECT_LT(covariance_error(tiny, reference::covariance_of(from)), 1e-7);
  double last = 0.0;
  for (const std::int64_t dt :
       {base::kSecond, 3600 * base::kSecond, 86'400 * 365 * base::kSecond, (std::int64_t{1} << 62) - from.time}) {
    for (const MotionModel& model : {kWheels, kBody}) {
      const Estimate later = predict(model, from, from.time + dt);
      expect_covariance(later);
      EXPECT_TRUE(std::isfinite(later.X_WM.x));
      EXPECT_LE(std::abs(later.X_WM.yaw), M_PI);
    }
    const double grown = predict(kWheels, from, from.time + dt).covariance[at(kX, kX)];
    EXPECT_GT(grown, last);
    last = grown;
  }
}

TEST(Measurements, VariancesAreLimited) {
  const auto valid = [](double variance) {
    return is_valid(
        {.pose_covariance = {variance, 0, 0, variance, 0, variance}, .twist_variance = {variance, variance, variance}});
  };
  EXPECT_TRUE(valid(1e-18));
  EXPECT_FALSE(valid(std::nextafter(1e-18, 0.0)));
  EXPECT_TRUE(valid(1e18));
  EXPECT_FALSE(valid(std::nextafter(1e18, HUGE_VAL)));
}

TEST(Measurements, BadNumbersAreInvalid) {
  EXPECT_TRUE(is_valid({}));
  EXPECT_TRUE(is_valid({.time = std::int64_t{1} << 62}));
  EXPECT_FALSE(is_valid({.time = -1}));
  EXPECT_FALSE(is_valid({.time = (std::int64_t{1} << 62) + 1}));
  EXPECT_FALSE(is_valid({.components = 0}));
  EXPECT_FALSE(is_valid({.components = 0x40}));
  EXPECT_FALSE(is_valid({.X_WM = {kNaN, 0, 0, 0}}));
  EXPECT_FALSE(is_valid({.X_WM = {0, 0, 0, HUGE_VAL}}));
  EXPECT_FALSE(is_valid({.X_WM = {1e300, 0, 0, 0}}));
  EXPECT_FALSE(is_valid({.velocity = {0, 0, kNaN}}));
  Measurement m;
  for (const double bad : {0.0, -1.0, kNaN, HUGE_VAL, 1e-300}) {
    m = {};
    m.pose_covariance[3] = bad;
    EXPECT_FALSE(is_valid(m)) << bad;
    m = {};
    m.twist_variance[2] = bad;
    EXPECT_FALSE(is_valid(m)) << bad;
  }
  m = {};
  for (const std::size_t pair : {1, 2, 4}) {  // full correlation of x and y, x and yaw, or y and yaw
    m.pose_covariance = {1, 0, 0, 1, 0, 1};
    m.pose_covariance[pair] = 1;
    EXPECT_FALSE(is_valid(m)) << pair;
  }
  m.pose_covariance = {1, 0.9, -0.9, 1, 0.9, 1};  // each pair is possible, all three are not
  EXPECT_FALSE(is_valid(m));
  m.pose_covariance = {1, 0.9, 0.9, 1, 0.9, 1};
  EXPECT_TRUE(is_valid(m));
  m.pose_covariance[1] = kNaN;
  EXPECT_FALSE(is_valid(m));
}

}  // namespace
}  // namespace sf::estimation
