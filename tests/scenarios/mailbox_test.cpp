#include "scenarios/mailbox.h"
#include "tests/units.h"

#include <gtest/gtest.h>

#include <array>

namespace sf::scenarios {
namespace {

/// Reading `sequence` of a sensor; its only value is its sequence.
class Sender {
 public:
  explicit Sender(std::uint8_t type = 1, std::uint32_t sensor = 0) : type_(type), sensor_(sensor) {}
  base::ReadingBlock reading(std::uint32_t sequence) {
    value_ = {static_cast<double>(sequence)};
    return {.sensor = sensor_, .type = type_, .sequence = sequence, .values = value_};
  }

 private:
  std::uint8_t type_;
  std::uint32_t sensor_;
  std::array<double, 1> value_{};
};

double newest(Mailbox& box, std::int64_t now) {
  const auto open = box.receive(now);
  return open.empty() ? -1.0 : open[0].values[0];
}

TEST(Mailbox, IsEmptyBeforeTheFirstReading) {
  Mailbox box({}, 0);
  EXPECT_TRUE(box.receive(0).empty());
  EXPECT_FALSE(box.renewed(1));
}

/// The farm reuses its memory in the next tick, so the mailbox must copy.
TEST(Mailbox, KeepsACopyUntilANewerOneArrives) {
  Mailbox box({}, 0);
  Sender sender;
  box.send(sender.reading(0), 0);
  EXPECT_EQ(newest(box, 0), 0.0);
  EXPECT_TRUE(box.renewed(1));
  sender.reading(99);
  EXPECT_EQ(newest(box, 50 * kMs), 0.0);
  EXPECT_FALSE(box.renewed(1));
  box.send(sender.reading(1), 100 * kMs);
  EXPECT_EQ(newest(box, 100 * kMs), 1.0);
}

/// A sensor's flags also change in place.
TEST(Mailbox, KeepsFlags) {
  Mailbox box({}, 0);
  Sender sender;
  base::ReadingBlock reading = sender.reading(0);
  base::QualityFlag flag = base::QualityFlag::grazing;
  reading.quality = {&flag, 1};
  box.send(reading, 0);
  flag = base::QualityFlag::none;
  ASSERT_EQ(box.receive(0)[0].quality.size(), 1u);
  EXPECT_EQ(box.receive(0)[0].quality[0], base::QualityFlag::grazing);
}

TEST(Mailbox, ADelayedReadingArrivesAfterItsDelay) {
  Mailbox box({.delay = 0.25}, 0);
  Sender sender;
  for (std::uint32_t k = 0; k < 10; ++k) {
    const std::int64_t now = k * 100 * kMs;
    box.send(sender.reading(k), now);
    // Sent at 100 k ms, received from 100 k + 250 ms on: at tick k the newest is k - 3.
    EXPECT_EQ(newest(box, now), k < 3 ? -1.0 : k - 3.0) << k;
  }
  EXPECT_EQ(newest(box, 1149 * kMs), 8.0);  // 9 was sent at 900 ms
  EXPECT_EQ(newest(box, 1150 * kMs), 9.0);
}

TEST(Mailbox, LostReadingsNeverArrive) {
  Mailbox box({.loss = 1.0}, 0);
  Sender sender;
  for (std::uint32_t k = 0; k < 20; ++k) box.send(sender.reading(k), k * 100 * kMs);
  EXPECT_TRUE(box.receive(1'000'000 * kMs).empty());
}

/// With much jitter readings overtake each other; the received sequence never decreases.
TEST(Mailbox, NeverGoesBack) {
  Mailbox box({.jitter = 1.0, .loss = 0.2, .seed = 3}, 7);
  Sender sender;
  double last = -1.0;
  int renewed = 0;
  for (std::uint32_t k = 0; k < 500; ++k) {
    const std::int64_t now = k * 100 * kMs;
    box.send(sender.reading(k), now);
    const double value = newest(box, now);
    EXPECT_GE(value, last);
    EXPECT_EQ(box.renewed(1), value > last);
    renewed += box.renewed(1);
    last = value;
  }
  // Some were overtaken or lost, most were not.
  EXPECT_GT(renewed, 150);
  EXPECT_LT(renewed, 400);
}

TEST(Mailbox, SensorsAndTypesAreSeparate) {
  Mailbox box({}, 0);
  Sender a(1, 0), b(1, 1), c(3, 0);
  box.send(a.reading(5), 0);
  box.send(b.reading(6), 0);
  box.send(c.reading(7), 0);
  const auto open = box.receive(0);
  ASSERT_EQ(open.size(), 3u);
  EXPECT_EQ(open[0].values[0], 5.0);
  EXPECT_EQ(open[1].values[0], 6.0);
  EXPECT_EQ(open[2].type, 3);
  box.send(c.reading(8), 1);
  box.receive(1);
  EXPECT_TRUE(box.renewed(3));
  EXPECT_FALSE(box.renewed(1));
}

/// The loss of a message depends on its robot.
TEST(Mailbox, RobotsLoseDifferentReadings) {
  Mailbox one({.loss = 0.5, .seed = 1}, 1), two({.loss = 0.5, .seed = 1}, 2);
  Sender sender;
  int apart = 0;
  for (std::uint32_t k = 0; k < 100; ++k) {
    one.send(sender.reading(k), k);
    two.send(sender.reading(k), k);
    apart += newest(one, k) != newest(two, k);
  }
  EXPECT_GT(apart, 10);
}

}  // namespace
}  // namespace sf::scenarios
