// Every piece of a loop is done once, by whoever is free.

#include "base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <vector>

namespace sf::base {
namespace {

TEST(Workers, EveryItemOnceWhateverThePiecesAndThreads) {
  for (const unsigned threads : {1u, 2u, 5u}) {
    Workers workers(threads);
    EXPECT_EQ(workers.threads(), threads);
    for (const std::size_t count : {0u, 1u, 2u, 63u, 1000u})
      for (const std::size_t piece : {1u, 7u, 64u, 5000u}) {
        std::vector<std::atomic<int>> visits(count);
        workers.run(count, piece, [&](std::size_t first, std::size_t last, unsigned thread) {
          EXPECT_LT(thread, threads);
          EXPECT_LT(first, last);
          for (std::size_t i = first; i < last; ++i) ++visits[i];
        });
        for (const auto& v : visits) EXPECT_EQ(v, 1);
      }
  }
}

/// Many short loops one after the other: none is missed, none overtakes.
TEST(Workers, ManyShortLoops) {
  Workers workers(3);
  std::atomic<std::uint64_t> sum{0};
  for (int round = 0; round < 3000; ++round) {
    const std::uint64_t before = sum;
    workers.run(4, 1, [&](std::size_t first, std::size_t last, unsigned) { sum += last - first; });
    ASSERT_EQ(sum, before + 4);
  }
}

TEST(Workers, AsManyAsTheMachineHasByDefault) { EXPECT_GE(Workers().threads(), 1u); }

}  // namespace
}  // namespace sf::base
