// Each piece of a loop runs exactly once.

#include "base/thread_pool.h"

#include <gtest/gtest.h>

#include <atomic>
#include <vector>

namespace sf::base {
namespace {

TEST(ThreadPool, EveryItemOnceWhateverThePiecesAndThreads) {
  for (const unsigned threads : {1u, 2u, 5u}) {
    ThreadPool thread_pool(threads);
    EXPECT_EQ(thread_pool.threads(), threads);
    for (const std::size_t count : {0u, 1u, 2u, 63u, 1000u})
      for (const std::size_t piece : {1u, 7u, 64u, 5000u}) {
        std::vector<std::atomic<int>> visits(count);
        thread_pool.parallel_for(count, piece, [&](std::size_t first, std::size_t last, unsigned thread) {
          EXPECT_LT(thread, threads);
          EXPECT_LT(first, last);
          for (std::size_t i = first; i < last; ++i) ++visits[i];
        });
        for (const auto& v : visits) EXPECT_EQ(v, 1);
      }
  }
}

/// Many short loops in sequence: no loop is lost, and none starts before the previous one has ended.
TEST(ThreadPool, ManyShortLoops) {
  ThreadPool thread_pool(3);
  std::atomic<std::uint64_t> sum{0};
  for (int round = 0; round < 3000; ++round) {
    const std::uint64_t before = sum;
    thread_pool.parallel_for(4, 1, [&](std::size_t first, std::size_t last, unsigned) { sum += last - first; });
    ASSERT_EQ(sum, before + 4);
  }
}

TEST(ThreadPool, AsManyAsTheMachineHasByDefault) { EXPECT_GE(ThreadPool().threads(), 1u); }

}  // namespace
}  // namespace sf::base
