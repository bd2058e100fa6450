// Consistency of TrackFilter with any measured components, over 300 simulated runs each: from the first measurement on,
// errors match the covariance, true measurements are used, and false ones are rejected.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "robots/estimation/chi_square.h"
#include "robots/estimation/track_filter.h"
#include "tests/instrumented.h"
#include "tests/robots/estimation/truth.h"
#include "tests/units.h"

namespace sf::estimation::track_consistency {
namespace {

const int kTrackRuns = instrumented() ? 20 : 300;
constexpr std::uint8_t kAny = 0x80;  // other components at each time, drawn at random

const MotionModel kDrive = differential_drive();
const MotionModel kBody = free_body();
const MotionModel kOmni{MotionModel::Path::arc, 0.1, 0.1, 1.0};

struct Case {
  std::string name;
  MotionModel model;
  std::uint8_t first = kPositionBits;  ///< components of the first measurement
  std::uint8_t components = kPositionBits;
  reference::Variances variances{1e-4, 4e-4, 25e-4, 1e-2};
  double rate = 15.0;  ///< [Hz]
  int steps = 20;
  double loss = 0.0;        ///< probability
  double delay = 0.0;       ///< [s] largest delay, uniform: measurements overtake each other
  double outliers = 0.0;    ///< probability of an error of 3 m
  double most_tail = 1.25;  ///< limit of the 99.9 % quantile of the errors, relative to the chi-square one
  double mean_off = 0.06;   ///< allowed difference of the mean per dimension from 1
};

struct Arrival {
  std::int64_t time = 0;
  Measurement measurement;
  bool is_true = true;
};

struct Result {
  std::vector<double> sums;    ///< NEES over runs, per step
  std::vector<double> errors;  ///< NEES of all runs and steps
  int degrees = 0;
  int refused = 0, measured = 0;  ///< true measurements
  int used = 0;                   ///< outliers
};

std::vector<Arrival> measure(const Case& c, reference::Truth truth, std::vector<reference::Vector>& states) {
  std::uniform_real_distribution<double> uniform;
  std::vector<Arrival> arrivals;
  for (int k = 0; k < c.steps; ++k) {
    const std::int64_t time = kSecond + static_cast<std::int64_t>(1e9 * k / c.rate);
    if (k > 0) truth.move(c.model, 1.0 / c.rate);
    states.push_back(truth.s);
    if (k > 0 && uniform(truth.random) < c.loss) continue;
    const auto any = static_cast<std::uint8_t>(1 + truth.random() % 63);
    Arrival a{time, truth.measure(k == 0 ? c.first : c.components == kAny ? any : c.components, time, c.variances)};
    if (k > 0) a.time += static_cast<std::int64_t>(1e9 * c.delay * uniform(truth.random));
    if (k > 0 && uniform(truth.random) < c.outliers) {
      a.is_true = false;
      const double direction = 2.0 * M_PI * uniform(truth.random);
      a.measurement.X_WM.x += 3.0 * std::cos(direction);
      a.measurement.X_WM.y += 3.0 * std::sin(direction);
    }
    arrivals.push_back(a);
  }
  std::stable_sort(arrivals.begin(), arrivals.end(), [](const auto& a, const auto& b) { return a.time < b.time; });
  return arrivals;
}

/// Draws the state at the first measurement from the model's prior.
Result simulate(const Case& c) {
  Result r{std::vector<double>(c.steps), {}};
  std::mt19937_64 random(20);
  for (int run = 0; run < kTrackRuns; ++run) {
    reference::Truth truth{{}, random, {}};
    const auto& [yaw, speed, turn] = c.model.unknown;
    const bool sideways = c.model.left > 0.0;
    truth.s = {100.0,
               -200.0,
               yaw * (2.0 * static_cast<double>(random() >> 11) * 0x1p-53 - 1.0),
               truth.normal(speed * speed),
               sideways ? truth.normal(speed * speed) : 0.0,
               truth.normal(turn * turn)};
    std::vector<reference::Vector> states;
    const std::vector<Arrival> arrivals = measure(c, truth, states);
    TrackFilter filter({.model = c.model});
    auto next = arrivals.begin();
    for (int k = 0; k < c.steps; ++k) {
      const std::int64_t now = kSecond + static_cast<std::int64_t>(1e9 * k / c.rate);
      for (; next != arrivals.end() && next->time <= now; ++next) {
        const bool used = filter.take(next->measurement, now) <= Verdict::used;
        if (next->is_true)
          r.refused += !used, ++r.measured;
        else
          r.used += used;
      }
      r.errors.push_back(reference::nees(filter.predict(now).estimate, states[k], r.degrees));
      r.sums[k] += r.errors.back();
    }
  }
  return r;
}

double mean(const std::vector<double>& v) {
  double sum = 0.0;
  for (const double each : v) sum += each;
  return sum / static_cast<double>(v.size());
}

/// Expects the NEES of all runs in the central 99 % of its chi-square distribution in all but 15 % of the steps
/// (neighbours are correlated), with mean 1 and the distribution's tail.
void expect_consistent(const Case& c) {
  SCOPED_TRACE(c.name);
  Result r = simulate(c);
  EXPECT_EQ(r.used, 0);
  if (instrumented()) return;  // too few runs for the rest
  const double low = chi_square_limit(kTrackRuns * r.degrees, 0.995),
               high = chi_square_limit(kTrackRuns * r.degrees, 0.005);
  const auto outside = std::count_if(r.sums.begin(), r.sums.end(), [&](double s) { return s < low || s > high; });
  EXPECT_LE(outside, c.steps * 3 / 20);
  EXPECT_NEAR(mean(r.errors) / r.degrees, 1.0, c.mean_off);
  std::sort(r.errors.begin(), r.errors.end());
  const double tail = r.errors[r.errors.size() * 999 / 1000] / chi_square_limit(r.degrees, 1e-3);
  EXPECT_GT(tail, 0.8);
  EXPECT_LT(tail, c.most_tail);
  // The gate rejects 1e-4 of true measurements.
  EXPECT_LE(r.refused, 1e-4 * r.measured + 4.0 * std::sqrt(1e-4 * r.measured));
}

TEST(TrackConsistency, PositionsAlone) {
  expect_consistent({.name = "differential drive", .model = kDrive, .steps = 90});
  expect_consistent({.name = "free body", .model = kBody});
  expect_consistent({.name = "omnidirectional", .model = kOmni});
  expect_consistent({.name = "5 Hz, 0.3 m", .model = kDrive, .variances = {0.09}, .rate = 5.0});
}

TEST(TrackConsistency, PositionsWithLossDelayAndOutliers) {
  for (const MotionModel& model : {kDrive, kOmni})
    expect_consistent({.name = "loss and delay", .model = model, .loss = 0.3, .delay = 0.2, .most_tail = 1.6});
  expect_consistent({.name = "outliers", .model = kDrive, .outliers = 0.05});
}

TEST(TrackConsistency, PositionsAndSomeOtherComponent) {
  for (const Component also : {kYaw, kForward, kTurn})
    expect_consistent({.name = "and component " + std::to_string(also),
                       .model = kDrive,
                       .components = static_cast<std::uint8_t>(kPositionBits | 1u << also)});
  for (const MotionModel& model : {kBody, kOmni})
    expect_consistent({.name = "and twist",
                       .model = model,
                       .first = kPositionBits | kTwistBits,
                       .components = kPositionBits | kTwistBits});
}

TEST(TrackConsistency, AnyComponentsAfterAPosition) {
  for (const MotionModel& model : {kDrive, kBody, kOmni})
    expect_consistent({.name = "any components", .model = model, .components = kAny, .most_tail = 1.6});
}

TEST(TrackConsistency, HeadingMeasuredOnce) {
  expect_consistent({.name = "a pose, then positions", .model = kDrive, .first = kPoseBits, .steps = 45});
}

TEST(TrackConsistency, PosesWithLossAndDelay) {
  // Between poses the heading is uncertain, and the position lies on an arc. The errors are not Gaussian: their mean
  // squares are correct, but the tail is longer than that of the chi-square distribution.
  for (const MotionModel& model : {kDrive, kBody})
    for (const std::uint8_t components : {kPoseBits, static_cast<std::uint8_t>(kPoseBits | kTwistBits)})
      expect_consistent({.name = "poses",
                         .model = model,
                         .first = components,
                         .components = components,
                         .loss = 0.3,
                         .delay = 0.2,
                         .most_tail = 1.6});
}

/// Gaps longer than `stale_after` restart the track, after its speeds have drifted beyond the prior of the model.
TEST(TrackConsistency, PosesWithGapsNearTheStaleTime) {
  for (const auto& [rate, loss] : {std::pair(5.0, 0.5), {15.0, 0.8}})
    expect_consistent({.name = "gaps",
                       .model = kDrive,
                       .first = kPoseBits,
                       .components = kPoseBits,
                       .variances = {1e-4, 4e-4},
                       .rate = rate,
                       .steps = static_cast<int>(8.0 * rate),
                       .loss = loss,
                       .most_tail = 4.0,
                       .mean_off = 0.15});
}

/// Ten poses in one second, then none for three seconds. The frozen pose is wrong by the distance driven since it was
/// frozen, and the velocity of 0 by the entire velocity.
TEST(TrackConsistency, StaleStates) {
  std::mt19937_64 random(21);
  for (const MotionModel& model : {kDrive, kBody, kOmni}) {
    std::vector<double> errors;
    int degrees = 0;
    for (int run = 0; run < kTrackRuns; ++run) {
      reference::Truth truth{{}, random, {}};
      truth.s[kYaw] = 2.0 * M_PI * static_cast<double>(random() >> 11) * 0x1p-53 - M_PI;
      truth.s[kForward] = truth.normal(0.25), truth.s[kTurn] = truth.normal(0.25);
      TrackFilter filter({.model = model});
      for (int k = 0; k < 40; ++k) {
        const std::int64_t now = kSecond + k * 100'000'000ll;
        if (k > 0) truth.move(model, 0.1);
        if (k <= 10) filter.take(truth.measure(kPoseBits, now, {1e-4, 4e-4}), now);
        const Prediction seen = filter.predict(now);
        if (seen.status != Prediction::Status::stale) continue;
        EXPECT_EQ(seen.estimate.velocity.forward, 0.0);
        errors.push_back(reference::nees(seen.estimate, truth.s, degrees));
      }
    }
    EXPECT_GE(errors.size(), 19u * static_cast<std::size_t>(kTrackRuns));
    if (!instrumented()) {
      EXPECT_NEAR(mean(errors) / degrees, 1.0, 0.15);
    }
  }
}

}  // namespace
}  // namespace sf::estimation::track_consistency
