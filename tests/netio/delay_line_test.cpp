#include "netio/delay_line.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace sf::netio {
namespace {

constexpr std::int64_t kMilli = 1'000'000;

base::Bytes bytes_of(std::uint32_t n) {
  base::Bytes bytes;
  base::ByteWriter(bytes).put(n);
  return bytes;
}

/// Messages released by `now`, as numbers.
std::vector<std::uint32_t> released(DelayLine& line, std::int64_t now) {
  std::vector<std::uint32_t> numbers;
  line.release(now, [&](std::size_t, std::span<const std::uint8_t> bytes) {
    numbers.push_back(base::ByteReader(bytes).get<std::uint32_t>());
  });
  return numbers;
}

void send(DelayLine& line, std::uint32_t n, std::int64_t now) { line.send({1, 2, n}, now, 0, bytes_of(n)); }

TEST(DelayLine, APerfectLinkHoldsNothingBack) {
  DelayLine line({});
  send(line, 3, 10);
  EXPECT_EQ(line.next(), 10);
  EXPECT_EQ(released(line, 10), std::vector<std::uint32_t>{3});
  EXPECT_EQ(line.next(), std::numeric_limits<std::int64_t>::max());
}

TEST(DelayLine, HoldsForItsDelay) {
  DelayLine line({.delay = 0.05});
  send(line, 1, 0);
  EXPECT_EQ(line.next(), 50 * kMilli);
  EXPECT_TRUE(released(line, 50 * kMilli - 1).empty());
  EXPECT_EQ(released(line, 50 * kMilli), std::vector<std::uint32_t>{1});
  EXPECT_TRUE(released(line, 100 * kMilli).empty());  // once
  EXPECT_EQ(line.counts().passed, 1u);
}

TEST(DelayLine, KeepsTheOrderOfWhatComesAtOnce) {
  DelayLine line({.delay = 0.05});
  for (std::uint32_t i = 0; i < 100; ++i) send(line, i, 0);
  const auto numbers = released(line, 50 * kMilli);
  for (std::uint32_t i = 0; i < 100; ++i) ASSERT_EQ(numbers[i], i);
}

TEST(DelayLine, TagsComeBack) {
  DelayLine line({});
  line.send({}, 0, 42, bytes_of(0));
  line.release(0, [](std::size_t tag, std::span<const std::uint8_t>) { EXPECT_EQ(tag, 42u); });
}

TEST(DelayLine, AllIsLostAtLossOne) {
  DelayLine line({.loss = 1.0});
  for (std::uint32_t i = 0; i < 100; ++i) send(line, i, 0);
  EXPECT_TRUE(released(line, 1'000'000 * kMilli).empty());
  EXPECT_EQ(line.counts().lost, 100u);
}

// With jitter messages arrive at the times of `sample_delay`, in order and once each, whenever they are released.
TEST(DelayLine, ReleasesInOrderOfArrival) {
  const LinkModel model{.delay = 0.01, .jitter = 0.2, .loss = 0.1, .seed = 5};
  std::mt19937 random(3);  // NOLINT: the same every time
  DelayLine line(model);
  std::uint64_t came = 0, lost = 0, overtaken = 0;
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
      ++came;
    }
    before = now;
    if (!sample_delay(model, {1, 2, n})) ++lost;
    send(line, n, now);
  }
  EXPECT_EQ(line.counts().lost, lost);
  EXPECT_EQ(line.counts().passed, came);
  EXPECT_GT(lost, 50u);
  EXPECT_GT(overtaken, 50u);
}

TEST(DelayLine, AFloodIsBounded) {
  DelayLine line({.delay = 1.0});
  for (std::uint32_t i = 0; i < DelayLine::kCapacity + 5; ++i) send(line, i, 0);
  EXPECT_EQ(line.waiting(), DelayLine::kCapacity);
  EXPECT_EQ(line.counts().full, 5u);
}

}  // namespace
}  // namespace sf::netio
