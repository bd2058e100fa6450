#include "netio/farm_clock.h"
#include "tests/units.h"

#include <gtest/gtest.h>

namespace sf::netio {
namespace {

TEST(FarmClock, EqualsTheRobotsClockBeforeTheFirstReading) {
  const FarmClock clock;
  EXPECT_FALSE(clock.synchronised());
  EXPECT_EQ(clock.to_farm(123), 123);
}

TEST(FarmClock, FollowsTheTimestamps) {
  FarmClock clock;
  clock.update(100 * kSecond, kSecond);
  EXPECT_TRUE(clock.synchronised());
  EXPECT_EQ(clock.to_farm(3 * kSecond), 102 * kSecond);
  EXPECT_EQ(clock.to_own(102 * kSecond), 3 * kSecond);
}

TEST(FarmClock, MayLagTheRobotsClock) {
  for (const std::int64_t arrival : {kSecond, 5 * kSecond}) {  // the first reading sets the clock, however early it is
    FarmClock clock;
    clock.update(0, arrival);
    EXPECT_EQ(clock.to_farm(6 * kSecond), 6 * kSecond - arrival);
  }
}

TEST(FarmClock, FastestReadingDeterminesTheEstimate) {
  FarmClock clock;
  clock.update(10 * kSecond, 50);
  clock.update(11 * kSecond, kSecond + 20);  // delay smaller by 30 ns
  clock.update(12 * kSecond, 2 * kSecond + 90);
  EXPECT_EQ(clock.to_farm(2 * kSecond + 20), 12 * kSecond);
}

TEST(FarmClock, RestartedFarmIsAcceptedAfterSilence) {
  FarmClock clock;
  clock.update(100 * kSecond, 0);
  clock.update(0, 2 * kSecond - 1);  // may be very late
  EXPECT_EQ(clock.to_farm(0), 100 * kSecond);
  clock.update(0, 4 * kSecond - 1);  // two seconds without readings
  EXPECT_EQ(clock.to_farm(4 * kSecond), 1);
}

}  // namespace
}  // namespace sf::netio
