#include "robots/estimation/track_filter.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "base/time.h"
#include "tests/units.h"

namespace sf::estimation {
namespace {

using Status = Prediction::Status;

FilterOptions options() {
  FilterOptions o;
  o.model = differential_drive();
  return o;
}

std::uint64_t count(const TrackFilter& filter, Verdict verdict) {
  return filter.counts()[static_cast<std::size_t>(verdict)];
}

/// Measurement of a robot that drives along x at 0.5 m/s.
Measurement along_x(std::int64_t ms, std::uint32_t sequence = 0) {
  Measurement m{.time = ms * kMs, .sequence = sequence};
  m.X_WM = {0.5e-3 * static_cast<double>(ms), 0, 0, 0};
  m.velocity = {0.5, 0, 0};
  return m;
}

/// Returns every bit of a filter's prediction.
std::vector<std::uint64_t> bits(const TrackFilter& filter, std::int64_t time) {
  const Prediction p = filter.predict(time);
  const Estimate& e = p.estimate;
  std::vector<std::uint64_t> all{static_cast<std::uint64_t>(p.status), static_cast<std::uint64_t>(p.age)};
  for (const double v :
       {e.X_WM.x, e.X_WM.y, e.X_WM.z, e.X_WM.yaw, e.velocity.forward, e.velocity.left, e.velocity.turn})
    all.push_back(std::bit_cast<std::uint64_t>(v));
  for (const double v : e.covariance) all.push_back(std::bit_cast<std::uint64_t>(v));
  all.insert(all.end(), filter.counts().begin(), filter.counts().end());
  return all;
}

// Measurements of several senders with equal stamps, outliers, jumps, gaps longer than the stale time and single
// components, in any order within the window.
rc::Gen<Measurement> any_measurement() {
  return rc::gen::exec([] {
    Measurement m;
    m.time = *rc::gen::inRange<std::int64_t>(0, 60) * 25 * kMs;  // few distinct times, so that many are equal
    m.source = *rc::gen::inRange(0u, 3u);
    m.sequence = *rc::gen::inRange(0u, 3u);
    m.components = *rc::gen::element<std::uint8_t>(kPoseBits | kTwistBits, kPoseBits, kPositionBits, 1u << kTurn,
                                                   1u << kForward | 1u << kTurn);
    const double far = *rc::gen::weightedElement<double>({{20, 0.0}, {2, 2.0}, {1, 4e5}});
    const auto noise = [] { return 0.001 * *rc::gen::inRange(-30, 31); };
    m.X_WM = {0.5e-9 * static_cast<double>(m.time) + far + noise(), noise(), 0, noise()};
    m.velocity = {0.5 + noise(), 0.0, noise()};
    return m;
  });
}

RC_GTEST_PROP(TrackFilterOrder, AnyOrderOfArrivalGivesTheBytesOfTheSortedOrder, ()) {
  auto measurements = *rc::gen::scale(3.0, rc::gen::container<std::vector<Measurement>>(any_measurement()));
  FilterOptions o = options();
  o.capacity = 1024;
  o.window = *rc::gen::element<std::int64_t>(200 * kMs, 600 * kMs, 2000 * kMs);
  o.stale_after = 300 * kMs;
  std::sort(measurements.begin(), measurements.end());

  // Delays of up to the window. Measurements arrive in order of time plus delay.
  std::vector<std::pair<std::int64_t, std::size_t>> arrivals;
  for (std::size_t k = 0; k < measurements.size(); ++k)
    arrivals.emplace_back(measurements[k].time + *rc::gen::inRange<std::int64_t>(0, o.window + 1), k);
  std::sort(arrivals.begin(), arrivals.end());

  TrackFilter sorted(o), mixed(o);
  const std::int64_t now = 2000 * kMs;
  for (const Measurement& m : measurements) sorted.take(m, now);
  for (const auto& [arrival, k] : arrivals) mixed.take(measurements[k], now);
  RC_ASSERT(count(mixed, Verdict::too_late) == 0u);
  RC_ASSERT(mixed.counts() == sorted.counts());
  for (const std::int64_t ms : {0, 700, 1400, 1475, 1500, 1800, 5000})
    RC_ASSERT(bits(mixed, ms * kMs) == bits(sorted, ms * kMs));
}

TEST(TrackFilterOrder, SignedZerosAreOrdered) {
  Measurement plus = along_x(0), minus = along_x(0);
  minus.X_WM.y = -0.0;
  TrackFilter a(options()), b(options());
  a.take(plus, kMs), a.take(minus, kMs);
  b.take(minus, kMs), b.take(plus, kMs);
  EXPECT_EQ(count(a, Verdict::replayed), 0u);
  EXPECT_EQ(bits(a, kMs), bits(b, kMs));
}

TEST(TrackFilter, NoMeasurementGivesNoState) {
  const TrackFilter filter(options());
  EXPECT_EQ(filter.predict(5).status, Status::none);
  EXPECT_EQ(filter.predict(std::int64_t{1} << 62).status, Status::none);
}

TEST(TrackFilter, PredictsToAnyTime) {
  TrackFilter filter(options());
  for (int ms = 0; ms <= 1000; ms += 100) filter.take(along_x(ms), ms * kMs);
  EXPECT_NEAR(filter.predict(1000 * kMs).estimate.X_WM.x, 0.5, 1e-12);
  EXPECT_NEAR(filter.predict(1080 * kMs).estimate.X_WM.x, 0.54, 1e-12);
  EXPECT_EQ(filter.predict(1080 * kMs).age, 80 * kMs);
  // Within the window: the state at that time. Before it: extrapolated backwards from the first estimate.
  EXPECT_EQ(filter.predict(250 * kMs).age, 50 * kMs);
  EXPECT_NEAR(filter.predict(250 * kMs).estimate.X_WM.x, 0.125, 1e-12);
  EXPECT_NEAR(filter.predict(-100 * kMs).estimate.X_WM.x, -0.05, 1e-12);
  EXPECT_EQ(filter.predict(-100 * kMs).age, -100 * kMs);
}

TEST(TrackFilter, LateMeasurementCountsAtItsTime) {
  TrackFilter filter(options());
  filter.take(along_x(0), 0);
  filter.take(along_x(200), 200 * kMs);
  EXPECT_EQ(filter.predict(150 * kMs).age, 150 * kMs);
  EXPECT_EQ(filter.take(along_x(100), 250 * kMs), Verdict::used);
  EXPECT_EQ(filter.predict(150 * kMs).age, 50 * kMs);
  EXPECT_EQ(filter.predict(250 * kMs).age, 50 * kMs);
}

TEST(TrackFilter, OutlierChangesNoBit) {
  TrackFilter with(options()), without(options());
  for (int ms = 0; ms < 1000; ms += 100)
    for (TrackFilter* filter : {&with, &without}) filter->take(along_x(ms), ms * kMs);
  Measurement wrong = along_x(950);
  wrong.X_WM.y = 1.0;
  EXPECT_EQ(with.take(wrong, 950 * kMs), Verdict::outlier);
  EXPECT_EQ(with.predict(990 * kMs).estimate.X_WM.x, without.predict(990 * kMs).estimate.X_WM.x);
  EXPECT_EQ(with.predict(990 * kMs).estimate.covariance, without.predict(990 * kMs).estimate.covariance);
  EXPECT_EQ(with.predict(990 * kMs).age, 90 * kMs);
}

TEST(TrackFilter, JumpOf400KilometresIsRejectedAsJump) {
  TrackFilter filter(options());
  filter.take(along_x(0), 0);
  Measurement far = along_x(100);
  far.X_WM.x += 4e5;
  EXPECT_EQ(filter.take(far, 100 * kMs), Verdict::jump);
  EXPECT_NEAR(filter.predict(100 * kMs).estimate.X_WM.x, 0.05, 1e-9);
  EXPECT_EQ(filter.take(along_x(200), 200 * kMs), Verdict::used);
}

TEST(TrackFilter, JumpIsRejectedForAnyUncertainty) {
  // A sender with an unknown position does not get a gate wider than max_jump.
  TrackFilter filter(options());
  Measurement vague = along_x(0);
  vague.pose_covariance = {1e12, 0, 0, 1e12, 0, 1};
  filter.take(vague, 0);
  vague.time = kMs;
  vague.X_WM.x = 10.5;
  EXPECT_EQ(filter.take(vague, kMs), Verdict::jump);
  vague.X_WM.x = 9.5;
  EXPECT_EQ(filter.take(vague, kMs), Verdict::used);
}

TEST(TrackFilter, WrongFirstPositionLastsForTheStaleTime) {
  TrackFilter filter(options());
  Measurement wrong = along_x(0);
  wrong.X_WM.x = 4e5;
  EXPECT_EQ(filter.take(wrong, 0), Verdict::started);
  for (int ms = 100; ms <= 1000; ms += 100) EXPECT_EQ(filter.take(along_x(ms), ms * kMs), Verdict::jump);
  EXPECT_EQ(filter.take(along_x(1100), 1100 * kMs), Verdict::started);
  EXPECT_NEAR(filter.predict(1100 * kMs).estimate.X_WM.x, 0.55, 1e-12);
}

TEST(TrackFilter, CarriedRobotWithLiveEncodersIsFoundAgain) {
  // Its turn rate is measured continuously, so its state never becomes stale.
  TrackFilter filter(options());
  filter.take(along_x(0), 0);
  for (int ms = 100; ms <= 1100; ms += 100) {
    Measurement turn = along_x(ms, 1);
    turn.components = 1u << kTurn;
    EXPECT_EQ(filter.take(turn, ms * kMs), Verdict::used);
    Measurement there = along_x(ms, 2);
    there.X_WM = {3, 3, 0, 1};
    EXPECT_EQ(filter.take(there, ms * kMs), ms <= 1000 ? Verdict::outlier : Verdict::started) << ms;
  }
  EXPECT_NEAR(filter.predict(1100 * kMs).estimate.X_WM.y, 3.0, 1e-12);
}

TEST(TrackFilter, ReplayedFutureLateAndInvalidAreCountedByReason) {
  TrackFilter filter(options());
  EXPECT_EQ(filter.take(along_x(2000), 2000 * kMs), Verdict::started);
  EXPECT_EQ(filter.take(along_x(2000), 2010 * kMs), Verdict::replayed);
  EXPECT_EQ(filter.take(along_x(2040), 2010 * kMs), Verdict::future);    // max_future is 20 ms
  EXPECT_EQ(filter.take(along_x(2030), 2010 * kMs), Verdict::used);      // exactly the limit
  EXPECT_EQ(filter.take(along_x(1029), 2040 * kMs), Verdict::too_late);  // the window is a second
  EXPECT_EQ(filter.take(along_x(1030), 2040 * kMs),
            Verdict::started);  // at the window's edge, before the first measurement
  Measurement bad = along_x(2040);
  bad.X_WM.yaw = kNaN;
  EXPECT_EQ(filter.take(bad, 2040 * kMs), Verdict::invalid);
  bad = along_x(std::numeric_limits<std::int64_t>::max() / kMs);
  EXPECT_EQ(filter.take(bad, 2040 * kMs), Verdict::invalid);
  const VerdictCounts expected{1, 2, 0, 0, 0, 1, 1, 1, 2};  // the first measurement of 2000 ms is now an update
  EXPECT_EQ(filter.counts(), expected);
}

TEST(TrackFilter, ReplayOfAMeasurementThatLeftTheWindowIsRejected) {
  TrackFilter filter(options());
  for (int ms = 0; ms <= 1500; ms += 100) filter.take(along_x(ms), ms * kMs);
  EXPECT_EQ(filter.take(along_x(400), 1500 * kMs), Verdict::replayed);  // the last that left
  EXPECT_EQ(filter.take(along_x(300), 1500 * kMs), Verdict::too_late);
  EXPECT_EQ(filter.take(along_x(500), 1500 * kMs), Verdict::replayed);
}

TEST(TrackFilter, FullRingShortensTheWindow) {
  FilterOptions o = options();
  o.capacity = 4;
  TrackFilter filter(o);
  for (int ms = 0; ms <= 900; ms += 100) EXPECT_LE(filter.take(along_x(ms), ms * kMs), Verdict::used);
  EXPECT_EQ(filter.take(along_x(550), 900 * kMs), Verdict::too_late);  // 600 to 900 are kept
  EXPECT_EQ(filter.take(along_x(650), 900 * kMs), Verdict::used);
  EXPECT_EQ(filter.predict(690 * kMs).age, 40 * kMs);
  o.capacity = 1;
  TrackFilter least(o);
  for (int ms = 0; ms <= 900; ms += 100) EXPECT_LE(least.take(along_x(ms), ms * kMs), Verdict::used);
  EXPECT_NEAR(least.predict(1000 * kMs).estimate.X_WM.x, 0.5, 1e-12);
}

TEST(TrackFilter, PositionIsNeededFirst) {
  TrackFilter filter(options());
  Measurement turn = along_x(0);
  turn.components = kTwistBits;
  EXPECT_EQ(filter.take(turn, 0), Verdict::no_track);
  EXPECT_EQ(filter.predict(0).status, Status::none);
  EXPECT_EQ(filter.take(along_x(10), 10 * kMs), Verdict::started);
  turn.time = 20 * kMs;
  EXPECT_EQ(filter.take(turn, 20 * kMs), Verdict::used);
}

TEST(TrackFilter, CovarianceGrowsThroughLossUntilTheStateIsStale) {
  TrackFilter filter(options());
  for (int ms = 0; ms <= 1000; ms += 100) filter.take(along_x(ms), ms * kMs);
  double last = 0.0;
  for (int ms = 1000; ms <= 2000; ms += 100) {
    const Prediction p = filter.predict(ms * kMs);
    EXPECT_EQ(p.status, Status::fresh);
    EXPECT_GT(p.estimate.covariance[0], last);
    last = p.estimate.covariance[0];
  }
  // One nanosecond later the state is stale: the pose is frozen, and the covariance still grows.
  const Prediction stale = filter.predict(2000 * kMs + 1);
  EXPECT_EQ(stale.status, Status::stale);
  EXPECT_NEAR(stale.estimate.X_WM.x, 1.0, 1e-12);
  EXPECT_EQ(stale.estimate.velocity.forward, 0.0);
  const Prediction later = filter.predict(60'000 * kMs);
  EXPECT_EQ(later.estimate.X_WM.x, stale.estimate.X_WM.x);
  EXPECT_GT(later.estimate.covariance[0], stale.estimate.covariance[0]);
  EXPECT_EQ(later.age, 59'000 * kMs);
}

/// A measurement of the turn rate alone has no pose to start at.
TEST(TrackFilter, OnlyAPositionRestartsAfterAStaleTime) {
  TrackFilter filter(options());
  for (int ms = 0; ms <= 1000; ms += 100) filter.take(along_x(ms), ms * kMs);
  Measurement turn{.time = 3000 * kMs, .sequence = 1, .components = 1u << kTurn};
  filter.take(turn, turn.time);
  EXPECT_EQ(count(filter, Verdict::started), 1u);
  EXPECT_GT(filter.predict(turn.time).estimate.X_WM.x, 0.9) << "its last position, or farther";
}

TEST(TrackFilter, FirstMeasurementAfterAStaleTimeRestarts) {
  TrackFilter filter(options());
  filter.take(along_x(0), 0);
  Measurement there = along_x(1001);
  there.X_WM = {50, 60, 0, 2};
  EXPECT_EQ(filter.take(there, 1001 * kMs), Verdict::started);
  EXPECT_EQ(filter.predict(1001 * kMs).estimate.X_WM.y, 60.0);
  EXPECT_EQ(filter.predict(1001 * kMs).estimate.covariance[0], there.pose_covariance[0]);
}

TEST(TrackFilter, ResetKeepsOnlyTheCounts) {
  TrackFilter filter(options());
  filter.take(along_x(5000), 5000 * kMs);
  filter.reset();
  EXPECT_EQ(filter.predict(5000 * kMs).status, Status::none);
  EXPECT_EQ(filter.take(along_x(0), 5000 * kMs), Verdict::started);  // a clock that restarted
  EXPECT_EQ(count(filter, Verdict::started), 2u);
}

TEST(TrackFilter, GateRejectsTheStatedShareOfTrueMeasurements) {
  // Pose errors of a robot at rest, drawn from the stated covariance of innovations: 1 % are rejected.
  FilterOptions o = options();
  o.gate = 0.01;
  std::uint64_t refused = 0;
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  constexpr int kTrials = 20'000;
  for (int k = 0; k < kTrials; ++k) {
    TrackFilter filter(o);
    Measurement m{.components = kPositionBits};
    m.X_WM = {0.01 * normal(random), 0.01 * normal(random), 0, 0};
    filter.take(m, 0);
    m.sequence = 1;
    m.X_WM = {0.01 * normal(random), 0.01 * normal(random), 0, 0};
    refused += filter.take(m, 0) == Verdict::outlier;
  }
  EXPECT_NEAR(static_cast<double>(refused), 0.01 * kTrials, 4.0 * std::sqrt(0.01 * kTrials));
}

}  // namespace
}  // namespace sf::estimation
