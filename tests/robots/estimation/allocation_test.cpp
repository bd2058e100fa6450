#include <gtest/gtest.h>

#include "robots/estimation/sender_clock.h"
#include "robots/estimation/track_filter.h"
#include "tests/counted_new.h"

namespace sf::estimation {
namespace {

TEST(EstimationAllocation, FilterDoesNotAllocateAfterConstruction) {
  TrackFilter filter({});
  SenderClock clock;
  std::int64_t t = 0;
  const auto lap = [&] {
    for (int k = 0; k < 200; ++k) {
      t += 10'000'000;
      clock.take(t, t + 1000);
      filter.take({.time = t}, t);
      filter.take({.time = t - 55'000'000 > 0 ? t - 55'000'000 : 0, .sequence = 1}, t);  // late: replayed
      filter.predict(t + 5'000'000);
    }
  };
  EXPECT_EQ(counted::when_warm(1, lap), 0u);
}

TEST(EstimationAllocation, HypothesesAreAllocatedOnce) {
  // Positions of a robot at rest: all headings, repeatedly in the same places of the window.
  TrackFilter filter({.capacity = 8});
  std::int64_t t = 0;
  const auto lap = [&] {
    for (int k = 0; k < 50; ++k) {
      t += 50'000'000;
      filter.take({.time = t, .components = kPositionBits}, t);
      filter.predict(t + 130'000'000);
    }
  };
  EXPECT_EQ(counted::when_warm(5, lap), 0u);
}

}  // namespace
}  // namespace sf::estimation
