#include "robots/estimation/arrival_monitor.h"

#include <gtest/gtest.h>

#include <functional>
#include <random>

namespace sf::estimation {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;

/// Adds states of ten per second with given delays. @return how often they counted as late
int times_late(int states, const std::function<std::int64_t(int)>& delay) {
  ArrivalMonitor monitor;
  int late = 0;
  std::int64_t arrival = 0;
  for (int k = 0; k < states; ++k) {
    const std::int64_t sent = k * 100 * kMillisecond;
    arrival = std::max(arrival, sent + delay(k) * kMillisecond);
    monitor.take(sent, arrival);
    late += monitor.is_late(arrival) ? 1 : 0;
  }
  return late;
}

TEST(ArrivalMonitor, ChangingDelaysAreLate) {
  for (const int jitter : {100, 200, 300, 500}) {
    std::mt19937 random(static_cast<unsigned>(jitter));
    const int late =
        times_late(300, [&](int) { return static_cast<std::int64_t>(random() % static_cast<unsigned>(jitter)); });
    EXPECT_GT(late, 200) << jitter;
  }
}

/// Boundary cases, each of which is not a link whose delays change.
TEST(ArrivalMonitor, OtherSendersAreNotLate) {
  const auto jitter = [](int k) { return std::int64_t{k * 7919 % 30}; };
  EXPECT_EQ(times_late(300, [](int) { return 0; }), 0) << "punctual";
  EXPECT_EQ(times_late(300, [](int) { return 800; }), 0) << "late by a constant";
  EXPECT_EQ(times_late(300, jitter), 0) << "30 ms of jitter";
  EXPECT_EQ(times_late(300, [](int k) { return k == 100 ? 900 : 5; }), 0) << "one straggler";
  EXPECT_EQ(times_late(300, [](int k) { return k < 100 ? 5 : 400; }), 0) << "a longer route, or a clock that is set";
  EXPECT_EQ(times_late(300, [](int k) { return 100 * k; }), 0) << "timestamps that are always 0";
  EXPECT_EQ(times_late(300, [](int k) { return 10 * k; }), 0) << "a simulation at 0.9 of real time";
  EXPECT_EQ(times_late(300, [](int k) { return 40 + (k < 250 ? 0 : 10) - k / 3; }), 0) << "a clock that drifts";
  EXPECT_EQ(times_late(ArrivalMonitor::kStates - 1, [](int k) { return k % 2 * 400; }), 0) << "too few";
}

TEST(ArrivalMonitor, LatenessHoldsForTenSeconds) {
  ArrivalMonitor monitor;
  EXPECT_EQ(monitor.least_gap(), 0);
  std::int64_t arrival = 0;
  for (int k = 0; k < 24; ++k) {
    arrival = 300 * k * kMillisecond + k * 5 % 4 * 60 * kMillisecond + 10 * kMillisecond;
    monitor.take(300 * k * kMillisecond, arrival);
  }
  EXPECT_TRUE(monitor.is_late(arrival + ArrivalMonitor::kHoldAfterLate - 100 * kMillisecond));
  EXPECT_FALSE(monitor.is_late(arrival + ArrivalMonitor::kHoldAfterLate + 1));
  EXPECT_EQ(monitor.least_gap(), 10 * kMillisecond);
  EXPECT_GE(monitor.spread(), 0);
  monitor.reset();
  EXPECT_FALSE(monitor.is_late(arrival));
}

}  // namespace
}  // namespace sf::estimation
