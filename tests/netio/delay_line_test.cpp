#include "netio/delay_line.h"

#include <gtest/gtest.h>

#include <bit>
#include <limits>
#include <numeric>
#include <random>

namespace sf::netio {
namespace {

constexpr std::int64_t kMilli = 1'000'000;

base::Bytes bytes_of(std::uint32_t n) {
  base::Bytes bytes;
  base::ByteWriter(bytes).put(n);
  return bytes;
}

/// Returns the messages released by `now`, as numbers.
std::vector<std::uint32_t> released(DelayLine& line, std::int64_t now) {
  std::vector<std::uint32_t> numbers;
  line.release(now, [&](std::size_t, std::span<const std::uint8_t> bytes) {
    numbers.push_back(base::ByteReader(bytes).get<std::uint32_t>());
  });
  return numbers;
}

void send(DelayLine& line, std::uint32_t n, std::int64_t now) { line.send({1, 2, n}, now, 0, bytes_of(n)); }

TEST(DelayLine, PerfectLinkAddsNoDelay) {
  DelayLine line({});
  send(line, 3, 10);
  EXPECT_EQ(line.next(), 10);
  EXPECT_EQ(released(line, 10), std::vector<std::uint32_t>{3});
  EXPECT_EQ(line.next(), std::numeric_limits<std::int64_t>::max());
}

TEST(DelayLine, DelaysMessages) {
  DelayLine line({.delay = 0.05});
  send(line, 1, 0);
  EXPECT_EQ(line.next(), 50 * kMilli);
  EXPECT_TRUE(released(line, 50 * kMilli - 1).empty());
  EXPECT_EQ(released(line, 50 * kMilli), std::vector<std::uint32_t>{1});
  EXPECT_TRUE(released(line, 100 * kMilli).empty());  // once
  EXPECT_EQ(line.counts().passed, 1u);
}

TEST(DelayLine, KeepsOrderOfSimultaneousArrivals) {
  DelayLine line({.delay = 0.05});
  for (std::uint32_t i = 0; i < 100; ++i) send(line, i, 0);
  const auto numbers = released(line, 50 * kMilli);
  for (std::uint32_t i = 0; i < 100; ++i) ASSERT_EQ(numbers[i], i);
}

TEST(DelayLine, ReturnsTags) {
  DelayLine line({});
  line.send({}, 0, 42, bytes_of(0));
  line.release(0, [](std::size_t tag, std::span<const std::uint8_t>) { EXPECT_EQ(tag, 42u); });
}

TEST(DelayLine, LossOfOneDropsEverything) {
  DelayLine line({.loss = 1.0});
  for (std::uint32_t i = 0; i < 100; ++i) send(line, i, 0);
  EXPECT_TRUE(released(line, 1'000'000 * kMilli).empty());
  EXPECT_EQ(line.counts().lost, 100u);
}

// With jitter, messages arrive at the times of `sample_delay`, in order and once each, whenever they are released.
TEST(DelayLine, ReleasesInOrderOfArrival) {
  const LinkModel model{.delay = 0.01, .jitter = 0.2, .loss = 0.1, .seed = 5};
  std::mt19937 random(3);  // NOLINT: the same every time
  DelayLine line(model);
  std::uint64_t arrived = 0, lost = 0, overtaken = 0;
  std::int64_t last = -1;
  std::uint32_t last_number = 0;
  std::int64_t before = 0;
  for (std::int64_t now = 0; now < 20'000 * kMilli; now += static_cast<std::int64_t>(random() % 40) * kMilli) {
    const auto n = static_cast<std::uint32_t>(now / kMilli);
    for (const std::uint32_t number : released(line, now)) {
      const std::int64_t arrival = number * kMilli + *sample_delay(model, {1, 2, number});
      ASSERT_GE(arrival, last);
      ASSERT_LE(arrival, now);
      ASSERT_GT(arrival, before) << "was due when we looked last";
      overtaken += number < last_number;
      last_number = number;
      last = arrival;
      ++arrived;
    }
    before = now;
    if (!sample_delay(model, {1, 2, n})) ++lost;
    send(line, n, now);
  }
  EXPECT_EQ(line.counts().lost, lost);
  EXPECT_EQ(line.counts().passed, arrived);
  EXPECT_GT(lost, 50u);
  EXPECT_GT(overtaken, 50u);
}

// Faults occur at the configured rate, within five standard deviations of 2000 messages.
TEST(DelayLine, DuplicatesAndCorruptsMessages) {
  constexpr int kMessages = 2000;
  DelayLine line({.delay = 0.01, .jitter = 0.1, .seed = 3, .duplicate = 0.25, .corrupt = 0.1});
  for (std::uint32_t n = 0; n < kMessages; ++n) send(line, n, n * kMilli);
  std::vector<int> copies(kMessages, 0);
  std::uint64_t odd = 0;
  line.release(1'000'000 * kMilli, [&](std::size_t, std::span<const std::uint8_t> bytes) {
    const auto number = base::ByteReader(bytes).get<std::uint32_t>();
    if (number < kMessages) ++copies[number];
    // A flipped bit changes the number, rarely to one that is in use, which then has too many copies.
    odd += number >= kMessages;
  });
  const DelayCounts& counts = line.counts();
  EXPECT_NEAR(static_cast<double>(counts.duplicated), 500.0, 97.0);
  EXPECT_NEAR(static_cast<double>(counts.corrupted), 200.0, 67.0);
  EXPECT_EQ(counts.passed, kMessages + counts.duplicated);
  EXPECT_EQ(counts.lost, 0u);
  EXPECT_GT(odd, counts.corrupted / 2) << "21 of 32 bits lead beyond 2000";
  EXPECT_EQ(static_cast<std::uint64_t>(std::accumulate(copies.begin(), copies.end(), 0)) + odd, counts.passed);
}

TEST(DelayLine, BothCopiesHaveTheSameFlippedBit) {
  DelayLine line({.seed = 3, .duplicate = 1.0, .corrupt = 1.0});
  for (std::uint32_t n = 0; n < 20; ++n) {
    send(line, n, 0);
    const std::vector<std::uint32_t> copies = released(line, 0);
    ASSERT_EQ(copies.size(), 2u);
    EXPECT_EQ(copies[0], copies[1]);
    EXPECT_EQ(std::popcount(copies[0] ^ n), 1);
  }
}

TEST(DelayLine, FaultsDependOnlyOnTheMessage) {
  const LinkModel model{.seed = 3, .duplicate = 0.5, .corrupt = 0.5};
  for (std::uint64_t n = 0; n < 50; ++n) {
    const MessageFaults one = sample_faults(model, {1, 2, n}), other = sample_faults(model, {1, 2, n});
    EXPECT_EQ(one.again, other.again);
    EXPECT_EQ(one.flipped_bit, other.flipped_bit);
  }
  const MessageFaults none = sample_faults({.loss = 0.5}, {1, 2, 3});
  EXPECT_FALSE(none.again || none.flipped_bit);
}

TEST(DelayLine, EmptyMessageIsNotCorrupted) {
  DelayLine line({.corrupt = 1.0});
  line.send({1, 2, 3}, 0, 0, {});
  line.release(0, [](std::size_t, std::span<const std::uint8_t> bytes) { EXPECT_TRUE(bytes.empty()); });
  EXPECT_EQ(line.counts().passed, 1u);
}

TEST(DelayLine, FloodIsBounded) {
  DelayLine line({.delay = 1.0});
  for (std::uint32_t i = 0; i < DelayLine::kCapacity + 5; ++i) send(line, i, 0);
  EXPECT_EQ(line.waiting(), DelayLine::kCapacity);
  EXPECT_EQ(line.counts().full, 5u);
}

}  // namespace
}  // namespace sf::netio
