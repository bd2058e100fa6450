#include "robots/estimation/sender_clock.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "base/time.h"
#include "tests/units.h"

namespace sf::estimation {
namespace {

using base::kSecond;
constexpr std::int64_t kLatest = std::int64_t{1} << 62;

/// A sender with a different clock, and a link with a least delay and exponential jitter.
struct Sender {
  std::int64_t offset = 0;  ///< [ns] receiver minus sender at the receiver's time 0
  double drift = 0.0;       ///< [s/s] growth of the offset
  std::int64_t least = 5 * kMs;
  double jitter = 20e6;  ///< [ns] mean
  std::mt19937_64 random{3};

  std::int64_t stamp(std::int64_t now) const { return now - offset - std::llround(drift * static_cast<double>(now)); }
  std::int64_t delay() { return least + std::llround(std::exponential_distribution<double>(1.0 / jitter)(random)); }
};

/// Sends 15 packets per second, from `begin` to `end` [s] of the receiver's time.
void run(SenderClock& clock, Sender& sender, double begin, double end) {
  for (double t = begin; t < end; t += 1.0 / 15.0) {
    const std::int64_t sent = base::nanoseconds(t);
    EXPECT_EQ(clock.take(sender.stamp(sent), sent + sender.delay()), ClockVerdict::used) << t;
  }
}

TEST(SenderClock, FindsOffsetAndDriftUnderJitter) {
  for (const double drift : {0.0, 50e-6, -200e-6, 400e-6}) {
    SenderClock clock({.least_delay = 5 * kMs});
    Sender sender{.offset = 3600 * kSecond, .drift = drift};
    sender.offset = -3600 * kSecond;  // the sender is an hour ahead
    run(clock, sender, 10.0, 100.0);
    EXPECT_TRUE(clock.state().drift_known);
    EXPECT_NEAR(clock.state().drift, drift, 20e-6);
    const std::int64_t now = 100 * kSecond;
    EXPECT_NEAR(static_cast<double>(clock.to_sender(now) - sender.stamp(now)), 0.0, 2e6) << drift;
  }
}

TEST(SenderClock, UnstatedDelayIsPartOfTheOffset) {
  SenderClock clock;
  Sender sender{.offset = 0, .jitter = 1.0};
  run(clock, sender, 1.0, 3.0);
  EXPECT_NEAR(static_cast<double>(clock.state().offset), 5e6, 1e3);
}

TEST(SenderClock, OffsetIsKnownFromTheFirstPacketAndImproves) {
  SenderClock clock;
  EXPECT_FALSE(clock.state().synchronised);
  clock.take(100 * kSecond, 7 * kSecond + 30 * kMs);
  EXPECT_TRUE(clock.state().synchronised);
  EXPECT_EQ(clock.to_sender(7 * kSecond + 30 * kMs), 100 * kSecond);
  clock.take(100 * kSecond + 100 * kMs, 7 * kSecond + 105 * kMs);  // 25 ms less delay
  EXPECT_EQ(clock.to_sender(7 * kSecond + 5 * kMs), 100 * kSecond);
  clock.take(100 * kSecond + 200 * kMs, 7 * kSecond + 290 * kMs);  // 85 ms more: jitter
  EXPECT_EQ(clock.to_sender(7 * kSecond + 5 * kMs), 100 * kSecond);
  EXPECT_EQ(clock.state().drift, 0.0);
}

TEST(SenderClock, OrderOfArrivalDoesNotMatter) {
  Sender sender{.offset = 42 * kSecond, .drift = 1e-4};
  std::vector<std::pair<std::int64_t, std::int64_t>> packets;  // stamp, arrival
  for (std::int64_t k = 0; k < 400; ++k) {
    const std::int64_t sent = 60 * kSecond + k * 67 * kMs;
    packets.emplace_back(sender.stamp(sent), sent + sender.delay());
  }
  SenderClock sorted, swapped;
  for (const auto& [sent, arrival] : packets) sorted.take(sent, arrival);
  for (std::size_t k = 0; k < packets.size(); k += 2) {
    swapped.take(packets[k + 1].first, packets[k + 1].second);
    swapped.take(packets[k].first, packets[k].second);
  }
  EXPECT_NEAR(sorted.state().drift, swapped.state().drift, 1e-12);
  EXPECT_NEAR(static_cast<double>(sorted.state().offset - swapped.state().offset), 0.0, 100.0);
}

TEST(SenderClock, DropsPacketsOutsideTheWindow) {
  // The least delay grows by 40 ms after two minutes, as on another route.
  SenderClock clock;
  Sender sender{.jitter = 1e6};
  run(clock, sender, 1.0, 120.0);
  sender.least += 40 * kMs;
  run(clock, sender, 120.0, 300.0);
  EXPECT_NEAR(static_cast<double>(clock.state().offset), 45e6, 1e6);
}

TEST(SenderClock, PacketFromBeforeTheWindowTakesNoSlot) {
  SenderClock clock({.max_delay = 100 * kSecond});
  clock.take(100 * kSecond, 100 * kSecond + 5 * kMs);
  clock.take(105 * kSecond, 105 * kSecond + 10 * kMs);
  clock.take(36 * kSecond, 106 * kSecond);  // 64 s before the first: the same slot
  EXPECT_EQ(clock.state().offset, 5 * kMs);
}

TEST(SenderClock, PacketFromTheFutureIsRejectedAndChangesNothing) {
  SenderClock clock;
  Sender sender;
  run(clock, sender, 1.0, 20.0);
  const ClockState before = clock.state();
  EXPECT_EQ(clock.take(3620 * kSecond, 20 * kSecond), ClockVerdict::future);
  EXPECT_EQ(clock.take(kLatest, 20 * kSecond), ClockVerdict::future);
  EXPECT_EQ(clock.take(11 * kSecond, 20 * kSecond + 100 * kMs), ClockVerdict::late);  // 9 s old by its stamp
  EXPECT_EQ(clock.take(0, 20 * kSecond + 100 * kMs), ClockVerdict::late);
  EXPECT_EQ(clock.state().offset, before.offset);
  EXPECT_EQ(clock.state().drift, before.drift);
  run(clock, sender, 20.2, 21.0);
}

TEST(SenderClock, LimitsAreInclusive) {
  SenderClock clock;
  clock.take(10 * kSecond, 10 * kSecond);
  EXPECT_EQ(clock.take(11 * kSecond, 12 * kSecond + 1), ClockVerdict::late);
  EXPECT_EQ(clock.take(11 * kSecond, 12 * kSecond), ClockVerdict::used);
  EXPECT_EQ(clock.take(12 * kSecond, 12 * kSecond - 250 * kMs - 1), ClockVerdict::future);
  EXPECT_EQ(clock.take(12 * kSecond, 12 * kSecond - 250 * kMs), ClockVerdict::used);
  EXPECT_EQ(clock.state().offset, -250 * kMs);
}

TEST(SenderClock, ClockResetIsFollowedAfterConfirmation) {
  for (const std::int64_t step : {3600 * kSecond, -3600 * kSecond}) {
    SenderClock clock;
    Sender sender{.offset = -7200 * kSecond};
    run(clock, sender, 1.0, 20.0);
    sender.offset += step;
    for (int k = 1; k <= SenderClock::kConfirmations; ++k) {
      const std::int64_t sent = 20 * kSecond + k * 67 * kMs;
      const ClockVerdict expected = k == SenderClock::kConfirmations ? ClockVerdict::stepped
                                    : step > 0                       ? ClockVerdict::late
                                                                     : ClockVerdict::future;
      EXPECT_EQ(clock.take(sender.stamp(sent), sent + sender.least), expected) << k;
    }
    EXPECT_EQ(clock.state().steps, 1u);
    run(clock, sender, 21.0, 22.0);
    EXPECT_NEAR(static_cast<double>(sender.stamp(22 * kSecond) - clock.to_sender(22 * kSecond)), 5e6, 1e6);
  }
}

TEST(SenderClock, ForgedStampsThatDisagreeDoNotSetTheClock) {
  SenderClock clock;
  Sender sender;
  run(clock, sender, 1.0, 20.0);
  std::mt19937_64 random(1);
  for (int k = 0; k < 1000; ++k) {
    const auto stamp = static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(kLatest));
    EXPECT_EQ(clock.take(stamp, 20 * kSecond + k * kMs), ClockVerdict::future);
  }
  // Forged stamps that agree do not either, as long as true ones arrive between them.
  for (int k = 0; k < 20; ++k) {
    const std::int64_t now = 21 * kSecond + k * 67 * kMs;
    EXPECT_EQ(clock.take(now + 1000 * kSecond, now), ClockVerdict::future);
    EXPECT_EQ(clock.take(sender.stamp(now), now + sender.delay()), ClockVerdict::used);
  }
  EXPECT_EQ(clock.state().steps, 0u);
}

TEST(SenderClock, ExtremeStampsDoNotOverflow) {
  for (const std::int64_t first : {std::int64_t{0}, kLatest})
    for (const std::int64_t second : {std::int64_t{0}, kLatest})
      for (const std::int64_t now : {std::int64_t{0}, kLatest}) {
        SenderClock clock;
        clock.take(first, kLatest - now);
        for (int k = 0; k < 10; ++k) clock.take(second, now);
        EXPECT_LE(std::abs(clock.state().drift), SenderClock::kMaxDrift);
      }
}

TEST(SenderClock, TrustedStampsAreUsedUnchanged) {
  SenderClock clock({.source = ClockSource::trusted});
  EXPECT_EQ(clock.take(10 * kSecond, 10 * kSecond + 30 * kMs), ClockVerdict::used);
  EXPECT_EQ(clock.to_sender(10 * kSecond), 10 * kSecond);
  for (int k = 0; k < 10; ++k) {  // no number of confirmations changes a trusted clock
    EXPECT_EQ(clock.take(11 * kSecond, 10 * kSecond), ClockVerdict::future);
    EXPECT_EQ(clock.take(1 * kSecond, 10 * kSecond), ClockVerdict::late);
  }
  EXPECT_FALSE(clock.state().synchronised) << "trust is no estimate of an offset";
}

TEST(SenderClock, ResetDropsTheOffset) {
  SenderClock clock;
  clock.take(10 * kSecond, 5 * kSecond);
  clock.reset();
  EXPECT_FALSE(clock.state().synchronised);
  EXPECT_EQ(clock.take(0, 6 * kSecond), ClockVerdict::used);
  EXPECT_EQ(clock.to_sender(6 * kSecond), 0);
}

}  // namespace
}  // namespace sf::estimation
