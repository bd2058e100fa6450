#include "robots/estimation/hypotheses.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "robots/estimation/track_filter.h"
#include "tests/robots/estimation/truth.h"
#include "tests/units.h"

namespace sf::estimation {
namespace {

constexpr std::size_t kYawYaw = kComponents * kYaw + kYaw;

const MotionModel kWheeled = differential_drive();
const MotionModel kSliding = free_body();

/// Has correlations between all components.
Estimate uncertain(double yaw_sigma) {
  Estimate e{kSecond, {1e5, -2.0, 0.3, 3.0}, {0.5, -0.2, 1.0}};
  const std::array<double, 6> sigma{0.1, 0.2, yaw_sigma, 0.3, 0.1, 0.2};
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) e.covariance[6 * i + j] = sigma[i] * sigma[j] * std::pow(-0.4, std::abs(i - j));
  return e;
}

Measurement position(std::int64_t ms, double x = 0.0, double y = 0.0) {
  return {.time = kSecond + ms * kMs, .components = kPositionBits, .X_WM = {x, y, 0.0, 0.0}};
}

double yaw_variance(const TrackFilter& filter, std::int64_t ms) {
  return filter.predict(kSecond + ms * kMs).estimate.covariance[kYawYaw];
}

TEST(Hypothesis, PartsHaveTheMomentsOfTheWhole) {
  for (const MotionModel& model : {kWheeled, kSliding})
    for (const double sigma : {0.06, 0.4, 2.0}) {
      const Hypothesis whole{0.25, uncertain(sigma)};
      for (const double narrow : {0.1, 0.5, 0.9}) {
        std::vector<Hypothesis> parts;
        split(model, whole, 0.1, narrow * middle_heading_sigma(whole.estimate, 0.1), parts);
        EXPECT_GE(parts.size(), 3u);
        for (const Hypothesis& part : parts)
          EXPECT_LT(middle_heading_sigma(part.estimate, 0.1), middle_heading_sigma(whole.estimate, 0.1));
        if (sigma > 1.0) continue;  // parts half a turn apart are not near each other
        const Hypothesis back = merged(model, parts);
        EXPECT_NEAR(back.weight, 0.25, 1e-15);
        EXPECT_NEAR(back.estimate.X_WM.x, 1e5, 1e-9);
        EXPECT_NEAR(back.estimate.velocity.left, -0.2, 1e-12);
        for (int k = 0; k < 36; ++k)
          EXPECT_NEAR(back.estimate.covariance[k], whole.estimate.covariance[k], 1e-10) << sigma << ' ' << k;
      }
    }
}

TEST(Hypothesis, YawErrorsAreWrapped) {
  // Compares with a million draws: the heading has a deviation of 0.4 rad and is 3 rad from the stated one.
  Estimate truth = uncertain(0.4), state = truth;
  state.X_WM.yaw = 0.0;
  for (const double side : {1.0, -1.0}) {
    truth.X_WM.yaw = 3.0 * side;
    Covariance sum{};
    add_square_error(state, {1.0, truth}, sum);
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal;
    double yaw_yaw = 0.0, yaw_forward = 0.0;
    constexpr int kDraws = 1'000'000;
    for (int k = 0; k < kDraws; ++k) {
      const double yaw = 0.4 * normal(random), forward = 0.3 * (-0.4 * yaw / 0.4 + std::sqrt(0.84) * normal(random));
      const double error = std::remainder(3.0 * side + yaw, 2.0 * M_PI);
      yaw_yaw += error * error / kDraws, yaw_forward += error * forward / kDraws;
    }
    EXPECT_NEAR(sum[kYawYaw], yaw_yaw, 0.01);
    EXPECT_NEAR(sum[kComponents * kYaw + kForward], yaw_forward, 0.005);
  }
}

TEST(Hypotheses, CertainHeadingsMatchASingleGaussian) {
  Measurement m{.time = kSecond, .X_WM = {1, 2, 0, 3}, .velocity = {0.5, 0, 0.3}};
  Estimate one = first_estimate(kWheeled, m);
  Hypotheses all;
  start(kWheeled, m, 64, all);
  for (int k = 1; k <= 20; ++k) {
    m.time += 50 * kMs;
    m.X_WM.x += 0.001 * (k % 3);
    const HypothesesLimits limits{64, one.time};
    one = correct(predict(kWheeled, one, m.time), m);
    predict(kWheeled, m.time, limits, all);
    correct(kWheeled, m, limits, all);
    ASSERT_EQ(all.size(), 1u);
    ASSERT_EQ(all[0].estimate.covariance, one.covariance);
    ASSERT_EQ(all[0].estimate.X_WM.x, one.X_WM.x);
  }
}

TEST(Hypotheses, LimitOfOneIsASingleGaussianForAnyHeading) {
  TrackFilter filter({.model = kWheeled, .hypotheses = 1});
  filter.take(position(0), kSecond);
  const Estimate first = first_estimate(kWheeled, position(0));
  EXPECT_EQ(filter.predict(kSecond + 500 * kMs).estimate.covariance,
            predict(kWheeled, first, kSecond + 500 * kMs).covariance);
}

TEST(Hypotheses, NeverExceedTheLimit) {
  for (const std::size_t most : {2u, 5u, 16u, 64u}) {
    Hypotheses all;
    start(kWheeled, position(0), most, all);
    for (std::int64_t ms = 500; ms < 5000; ms += 500) {
      const HypothesesLimits limits{most, all[0].estimate.time};
      predict(kWheeled, position(ms).time, limits, all);
      EXPECT_LE(all.size(), most);
      correct(kWheeled, position(ms), limits, all);
      EXPECT_LE(all.size(), most);
      double sum = 0.0;
      for (const Hypothesis& h : all) sum += h.weight;
      EXPECT_NEAR(sum, 1.0, 1e-12);
    }
  }
}

TEST(Hypotheses, WideHeadingKeepsItsDeviation) {
  Measurement m = position(0);
  m.components = kPoseBits;
  m.X_WM.yaw = 3.0;
  m.pose_covariance[5] = 0.49;
  Hypotheses all;
  start(kWheeled, m, 64, all);
  EXPECT_NEAR(base::wrap_angle(most_probable(all).X_WM.yaw - 3.0), 0.0, 0.14);
  EXPECT_NEAR(covariance_about(most_probable(all), all)[kYawYaw], 0.49, 0.03);
}

TEST(Heading, RobotAtRestStaysUnknown) {
  // All headings are equally likely: the mean square of an error in (-pi, pi) is pi^2 / 3.
  for (const MotionModel& model : {kWheeled, kSliding}) {
    TrackFilter filter({.model = model});
    for (std::int64_t ms = 0; ms <= 20'000; ms += 66) {
      EXPECT_LE(filter.take(position(ms), kSecond + ms * kMs), Verdict::used);
      EXPECT_NEAR(yaw_variance(filter, ms), M_PI * M_PI / 3.0, 0.35);
    }
  }
}

TEST(Heading, RobotTurningInPlaceStaysUnknown) {
  TrackFilter filter({.model = kWheeled});
  for (std::int64_t ms = 0; ms <= 5'000; ms += 66) {
    Measurement m = position(ms);
    m.components |= 1u << kTurn;
    m.velocity.turn = 1.0;
    EXPECT_LE(filter.take(m, m.time), Verdict::used);
    EXPECT_NEAR(yaw_variance(filter, ms), M_PI * M_PI / 3.0, 0.35);
  }
}

TEST(Heading, DrivenPathGivesTheHeadingOrItsOpposite) {
  // Along y: the opposite heading remains possible until a speed is measured, forwards or backwards.
  for (const double speed : {0.5, -0.5}) {
    TrackFilter filter({.model = kWheeled});
    for (std::int64_t ms = 0; ms <= 3'000; ms += 66)
      filter.take(position(ms, 0.0, 0.5e-3 * static_cast<double>(ms)), kSecond + ms * kMs);
    const Estimate both = filter.predict(kSecond + 3'000 * kMs).estimate;
    EXPECT_NEAR(both.X_WM.yaw, M_PI / 2.0, 0.2);
    EXPECT_NEAR(both.velocity.forward, 0.5, 0.1);
    EXPECT_NEAR(both.covariance[kYawYaw], M_PI * M_PI / 2.0, 0.5);
    Measurement speeds = position(3'000, 0.0, 1.5);
    speeds.components = 1u << kForward;
    speeds.velocity.forward = speed;
    EXPECT_EQ(filter.take(speeds, speeds.time), Verdict::used);
    const Estimate one = filter.predict(speeds.time).estimate;
    EXPECT_NEAR(one.X_WM.yaw, std::copysign(M_PI / 2.0, speed), 0.2);
    EXPECT_LT(one.covariance[kYawYaw], 0.04);
  }
}

TEST(Heading, PredictionsDependOnlyOnMeasurements) {
  // They must not depend on earlier predictions, whose steps they continue.
  TrackFilter often({.model = kWheeled}), once({.model = kWheeled});
  for (std::int64_t ms = 0; ms <= 400; ms += 66)
    for (TrackFilter* filter : {&often, &once})
      filter->take(position(ms, 0.3e-3 * static_cast<double>(ms)), kSecond + ms * kMs);
  for (std::int64_t ms = 0; ms < 2'500; ms += 37) often.predict(kSecond + ms * kMs);
  for (const std::int64_t ms : {2'500, 450, 430, 1'396, 100, 1'497, 996, 10'000}) {
    TrackFilter fresh = once;
    EXPECT_EQ(often.predict(kSecond + ms * kMs).estimate.covariance,
              fresh.predict(kSecond + ms * kMs).estimate.covariance)
        << ms;
  }
}

}  // namespace
}  // namespace sf::estimation
