#include "robots/estimation/localization.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/time.h"
#include "tests/units.h"

namespace sf::estimation {
namespace {

constexpr double kBias = 0.01;  // [rad/s]

/// Rests for `rest` readings, then drives straight ahead at 0.2 m/s for 600 readings, with a biased gyro.
base::Pose reckoned(Localization& localization, int rest) {
  for (int k = 0; k <= rest + 600; ++k) {
    const double rolled = 0.02 * std::max(0, k - rest);
    localization.add_encoder(k * kTick, rolled, rolled);
    localization.add_gyro(k * kTick, kBias);
  }
  return localization.predict((rest + 600) * kTick).estimate.X_WM;
}

TEST(Localization, GyroBiasIsEstimatedFromTheWheels) {
  Localization none({}, {}, 0), after_rest({}, {}, 0);
  EXPECT_NEAR(reckoned(after_rest, 20).x, 12.0, 0.02);
  EXPECT_NEAR(reckoned(after_rest, 20).y, 0.0, 0.2) << "two seconds at rest";
  EXPECT_LT(std::abs(reckoned(none, 0).y), 0.5 * 12.0 * 60.0 * kBias / 2.0) << "while driving, less than half is left";
}

TEST(Localization, NonFiniteReadingsChangeNothing) {
  Localization localization({}, {1.0, 2.0, 0.0, 0.5}, 0);
  localization.add_encoder(kTick, 0.0, 0.0);
  localization.add_encoder(2 * kTick, kNaN, 0.0);
  localization.add_encoder(3 * kTick, std::numeric_limits<double>::max(), -std::numeric_limits<double>::max());
  localization.add_gyro(3 * kTick, kInf);
  localization.add_gyro(3 * kTick, 1e9);  // a spike must not become the bias
  localization.add_gps(3 * kTick, kNaN, kNaN, kNaN);
  localization.add_gps(3 * kTick, 1.0, 2.0, kNaN);
  const Prediction now = localization.predict(3 * kTick);
  EXPECT_NEAR(now.estimate.X_WM.x, 1.0, 1e-9);
  EXPECT_NEAR(now.estimate.X_WM.yaw, 0.5, 1e-9);
  localization.add_gyro(4 * kTick, 0.0);
  EXPECT_NEAR(localization.predict(4 * kTick).estimate.velocity.turn, 0.0, 1e-6);
}

TEST(Localization, TurnsBetweenTwoCountsAreNotBias) {
  // 0.02 rad/s in place: one count of each wheel in four readings.
  Localization localization({}, {}, 0);
  for (int k = 0; k <= 600; ++k) {
    const double rolled = 1e-3 * std::round(0.02 * 0.1 * k * 0.258 / 2.0 / 1e-3);
    localization.add_encoder(k * kTick, -rolled, rolled);
    localization.add_gyro(k * kTick, 0.02);
  }
  EXPECT_NEAR(localization.predict(600 * kTick).estimate.X_WM.yaw, 1.2, 0.1)
      << "slip gives counts a little less weight than none";
}

TEST(Localization, RestBeforeALossOfTheEncodersDoesNotChangeTheBias) {
  // At rest until 0.1 s, no readings until 3.1 s, then 1 rad/s with the gyro alone.
  Localization localization({}, {}, 0);
  for (int k = 0; k <= 1; ++k) localization.add_encoder(k * kTick, 0.0, 0.0);
  for (int k = 31; k <= 60; ++k) localization.add_gyro(k * kTick, 1.0);
  EXPECT_NEAR(localization.predict(60 * kTick).estimate.velocity.turn, 1.0, 0.01);
}

TEST(Localization, TurnsRightAfterARestAreNotBias) {
  // The gyro's reading arrives first, and is compared with the rest one tick before.
  Localization localization({}, {}, 0);
  for (int k = 0; k <= 60; ++k) {
    const double turned = 0.1 * std::max(0, k - 30);
    localization.add_gyro(k * kTick, k > 30 ? 1.0 : 0.0);
    localization.add_encoder(k * kTick, -0.129 * turned, 0.129 * turned);
  }
  EXPECT_NEAR(localization.predict(60 * kTick).estimate.velocity.turn, 1.0, 0.01);
}

TEST(Localization, PositionsMayBeASecondLateAtHighRates) {
  Localization localization({}, {}, 0);
  for (int k = 0; k <= 500; ++k) {
    localization.add_encoder(k * 4 * kMs, 0.0, 0.0);
    localization.add_gyro(k * 4 * kMs, 0.0);
  }
  localization.add_gps(kSecond, 0.0, 0.0, 1.0);
  EXPECT_EQ(localization.counts()[static_cast<std::size_t>(Verdict::too_late)], 0u);
}

TEST(Localization, LatePositionsApplyAtTheirOwnTime) {
  // 0.2 m/s; the fix of half a second ago puts the start 1 m farther left.
  Localization on_time({.gps_noise = 1e-3, .start_position = 1.0}, {}, 0);
  Localization late({.gps_noise = 1e-3, .start_position = 1.0}, {}, 0);
  for (int k = 0; k <= 20; ++k) {
    for (Localization* each : {&on_time, &late}) each->add_encoder(k * kTick, 0.02 * k, 0.02 * k);
    if (k == 15) on_time.add_gps(k * kTick, 0.3, 1.0, 1.0);
  }
  late.add_gps(15 * kTick, 0.3, 1.0, 1.0);
  const base::Pose a = on_time.predict(20 * kTick).estimate.X_WM, b = late.predict(20 * kTick).estimate.X_WM;
  EXPECT_NEAR(a.x, 0.4, 0.01);
  EXPECT_NEAR(a.y, 1.0, 0.01);
  EXPECT_NEAR(a.x, b.x, 1e-12);
  EXPECT_NEAR(a.y, b.y, 1e-12);
}

}  // namespace
}  // namespace sf::estimation
