#include "server/state_filter.h"

#include <gtest/gtest.h>

#include <array>
#include <random>

#include "base/time.h"
#include "tests/robots/scenes.h"
#include "tests/units.h"

namespace sf::server {
namespace {

using base::kSecond;
using estimation::ClockVerdict;
using estimation::StalePolicy;
using estimation::Verdict;

/// One robot whose sender's clock is an hour ahead, driving along x at 0.5 m/s.
struct Fixture {
  explicit Fixture(StateFilterOptions chosen = {}) : world(scenes::boxed_world(100.0, 100.0, {-50.0, -50.0})) {
    scenes::add_mover(world, {}, scenes::rectangle({0.0, 0.0}, 0.3, 0.3));
    chosen.mode = FilterMode::on;
    filter.emplace(world, chosen);
  }
  /// Adds the state of `sent` [ns] on our clock, with sequence number sent / 100 ms.
  void take(std::int64_t sent, std::int64_t arrival, const base::Pose& error = {}) {
    netio::Header header;
    header.time = sent + 3600 * kSecond;
    header.sequence = static_cast<std::uint32_t>(sent / (100 * kMs));
    header.session = session;
    header.state = {.stated = stated[0] != 0.0f, .covariance = stated};
    base::Report report{0, header.time, {0.5e-9 * static_cast<double>(sent), 0, 0, 0}, {0.5, 0, 0}};
    report.X_WM = base::compose(report.X_WM, error);
    filter->take(report, header, arrival);
  }
  std::uint64_t count(Verdict verdict) const { return filter->counts().states[static_cast<std::size_t>(verdict)]; }
  std::uint64_t count(ClockVerdict verdict) const { return filter->counts().clocks[static_cast<std::size_t>(verdict)]; }

  world::World world;
  std::optional<StateFilter> filter;
  std::uint32_t session = 1;
  std::array<float, 6> stated{};  ///< covariance in the next states; 0: not stated
};

StateFilterOptions with_delay(std::int64_t least) {
  StateFilterOptions options;
  options.clock.least_delay = least;
  return options;
}

TEST(StateFilter, LateStatesArePredictedToNow) {
  // 10 Hz, 80 ms to 100 ms in transit, every twentieth lost: the pose is the current one, not that of 0.1 s ago.
  Fixture f(with_delay(80 * kMs));
  std::mt19937 random(1);
  for (std::int64_t sent = 0; sent < 5 * kSecond; sent += 100 * kMs)
    if (random() % 20 != 0) f.take(sent, sent + 80 * kMs + static_cast<std::int64_t>(random() % 20) * kMs);
  const auto& reports = f.filter->predict(5 * kSecond);
  ASSERT_EQ(reports.size(), 1u);
  EXPECT_EQ(reports[0].time, 5 * kSecond);
  EXPECT_NEAR(reports[0].X_WM.x, 2.5, 1e-3);
  const netio::StateQuality& quality = f.filter->quality(0);
  EXPECT_TRUE(quality.stated);
  EXPECT_FALSE(quality.stale);
  EXPECT_NEAR(static_cast<double>(quality.age), 100e6, 2e6);
  EXPECT_GT(quality.covariance[0], 0.0f);
  const auto clocks = f.filter->clocks();
  ASSERT_EQ(clocks.size(), 1u);
  EXPECT_NEAR(static_cast<double>(clocks[0].clock.offset), -3600e9, 2e6);
}

// The filter ignores matrices that are not covariances, and raises standard deviations below 0.1 mm to that.
TEST(StateFilter, UsesStatedCovariancesThatArePossible) {
  const auto variance = [](const std::array<float, 6>& stated) {
    Fixture f;
    f.stated = stated;
    f.take(0, 0);
    f.filter->predict(0);
    return f.filter->quality(0).covariance[0];
  };
  const float standard = variance({});
  EXPECT_NEAR(standard, 1e-4f, 1e-6f) << "10 mm";
  EXPECT_NEAR(variance({0.04f, 0, 0, 0.04f, 0, 0.01f}), 0.04f, 1e-4f);
  EXPECT_NEAR(variance({1e-14f, 0, 0, 1e-14f, 0, 1e-14f}), 1e-8f, 1e-9f) << "raised";
  EXPECT_EQ(variance({1, 2, 0, 1, 0, 1}), standard) << "not positive definite";
  EXPECT_EQ(variance({1, 0, 0, 1, 0, 0}), standard) << "no yaw";
  EXPECT_EQ(variance({1e30f, 0, 0, 1e30f, 0, 1}), standard) << "too large";
}

TEST(StateFilter, ReplaysAreDetectedAfterAClockCorrection) {
  Fixture f;
  f.take(1000 * kMs, 1090 * kMs);
  f.take(1100 * kMs, 1120 * kMs);  // 70 ms less delay: all times shift on our clock
  f.take(1000 * kMs, 1200 * kMs);
  f.take(1100 * kMs, 1210 * kMs);
  EXPECT_EQ(f.count(Verdict::replayed), 2u);
}

TEST(StateFilter, FutureOldAndFarStatesAreCountedAndIgnored) {
  Fixture f;
  for (std::int64_t sent = 1000 * kMs; sent <= 2000 * kMs; sent += 100 * kMs) f.take(sent, sent + 5 * kMs);
  const base::Report before = f.filter->predict(2005 * kMs)[0];
  f.take(9000 * kMs, 2005 * kMs);                  // seven seconds ahead
  f.take(0, 2006 * kMs);                           // two seconds old
  f.take(1950 * kMs, 2006 * kMs, {4e5, 0, 0, 0});  // 400 km away
  f.take(1960 * kMs, 2006 * kMs, {0, 1.0, 0, 0});  // 1 m sideways
  const base::Report after = f.filter->predict(2005 * kMs)[0];
  EXPECT_EQ(after.X_WM.x, before.X_WM.x);
  EXPECT_EQ(after.X_WM.y, before.X_WM.y);
  EXPECT_EQ(f.count(ClockVerdict::future), 1u);
  EXPECT_EQ(f.count(ClockVerdict::late), 1u);
  EXPECT_EQ(f.count(Verdict::jump), 1u);
  EXPECT_EQ(f.count(Verdict::outlier), 1u);
}

TEST(StateFilter, SilenceMakesAStateStaleByThePolicy) {
  for (const StalePolicy policy : {StalePolicy::freeze, StalePolicy::hide, StalePolicy::drop}) {
    StateFilterOptions options;
    options.policy = policy;
    Fixture f(options);
    f.take(1000 * kMs, 1000 * kMs);
    f.filter->predict(1900 * kMs);
    EXPECT_FALSE(f.filter->quality(0).stale);
    EXPECT_FALSE(f.filter->is_gone(0));
    f.filter->predict(2100 * kMs);
    EXPECT_TRUE(f.filter->quality(0).stale);
    EXPECT_EQ(f.filter->is_gone(0), policy != StalePolicy::freeze);
    EXPECT_EQ(f.filter->clocks().size(), policy == StalePolicy::drop ? 0u : 1u);
    f.filter->predict(9000 * kMs);
    EXPECT_TRUE(f.filter->quality(0).stale);
    f.take(9000 * kMs, 9000 * kMs);
    const auto& reports = f.filter->predict(9000 * kMs);
    EXPECT_FALSE(f.filter->quality(0).stale);
    EXPECT_FALSE(f.filter->is_gone(0));
    EXPECT_NEAR(reports.at(0).X_WM.x, 4.5, 1e-9);
  }
}

TEST(StateFilter, ANewSessionStartsOver) {
  Fixture f;
  f.take(1000 * kMs, 1000 * kMs);
  f.session = 2;
  f.take(500 * kMs, 1100 * kMs, {30.0, 0, 0, 0});  // another clock, another place
  EXPECT_EQ(f.count(Verdict::started), 2u);
  EXPECT_NEAR(f.filter->predict(1100 * kMs).at(0).X_WM.x, 30.25, 1e-9);
}

TEST(StateFilter, StampsAreIgnoredIfConfigured) {
  StateFilterOptions options;
  options.clock.source = estimation::ClockSource::arrival;
  Fixture f(options);
  f.take(1000 * kMs, 5000 * kMs);
  f.take(9000 * kMs, 5100 * kMs, {-4.0 + 0.05, 0, 0, 0});
  EXPECT_EQ(f.count(Verdict::used), 1u);
  EXPECT_EQ(f.filter->predict(5100 * kMs).at(0).time, 5100 * kMs);
}

TEST(StateFilter, TrustedStampsCountFromTheEpoch) {
  StateFilterOptions options;
  options.clock.source = estimation::ClockSource::trusted;
  options.epoch = 3600 * kSecond;
  Fixture f(options);
  f.take(1000 * kMs, 1080 * kMs);
  EXPECT_NEAR(f.filter->predict(1080 * kMs).at(0).X_WM.x, 0.54, 1e-9);
  f.take(3000 * kMs, 1100 * kMs);
  EXPECT_EQ(f.count(ClockVerdict::future), 1u);
  EXPECT_TRUE(f.filter->clocks().empty()) << "no offset was estimated";
}

/// Each late state reapplies a window of states, so their number bounds the work of a tick.
TEST(StateFilter, AFloodBetweenTwoPredictionsIsDroppedAndCounted) {
  Fixture f;
  constexpr std::int64_t kMost = StateFilter::kMostBetweenPredictions;
  for (std::int64_t k = 0; k < kMost + 10; ++k) f.take(1000 * kMs + k * kMs, 1005 * kMs + k * kMs);
  EXPECT_EQ(f.filter->counts().flooded, 10u);
  EXPECT_EQ(f.count(ClockVerdict::used), static_cast<std::uint64_t>(kMost));
  f.filter->predict(1100 * kMs);
  f.take(1100 * kMs, 1105 * kMs);
  EXPECT_EQ(f.filter->counts().flooded, 10u) << "the next tick takes as many";
  EXPECT_EQ(f.count(ClockVerdict::used), static_cast<std::uint64_t>(kMost) + 1);
}

TEST(StateFilter, MoverWithoutAStateHasNoReport) {
  Fixture f;
  EXPECT_TRUE(f.filter->predict(kSecond).empty());
  EXPECT_FALSE(f.filter->quality(0).stated);
}

}  // namespace
}  // namespace sf::server
