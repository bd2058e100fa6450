// Each piece of a loop runs exactly once.

#include "base/thread_pool.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <new>
#include <vector>

namespace sf::base {
namespace {

TEST(ThreadPool, RunsEveryItemOnce) {
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

/// An exception on any thread is rethrown after the other threads finish their pieces. The next loop runs normally.
TEST(ThreadPool, ExceptionsReachTheCaller) {
  ThreadPool thread_pool(3);
  for (const std::size_t bad : {0u, 50u, 99u}) {
    std::vector<std::atomic<int>> visits(100);
    EXPECT_THROW(thread_pool.parallel_for(visits.size(), 1,
                                          [&](std::size_t first, std::size_t, unsigned) {
                                            ++visits[first];
                                            if (first == bad) throw std::bad_alloc();
                                          }),
                 std::bad_alloc);
    for (const auto& v : visits) EXPECT_EQ(v, 1);
  }
  std::atomic<int> more{0};
  thread_pool.parallel_for(100, 1, [&](std::size_t, std::size_t, unsigned) { ++more; });
  EXPECT_EQ(more, 100);
}

/// As under `ulimit -u` or `ulimit -v`: a loop runs with the available threads. A thread's stack takes 8 MiB of address
/// space.
TEST(ThreadPool, RunsWithFewerThreads) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &before), 0);
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  const rlimit small{pages * static_cast<rlim_t>(getpagesize()) + (40u << 20), before.rlim_max};
  if (pages > (std::size_t{1} << 34) / 4096) GTEST_SKIP() << "sanitizers take all addresses";
  ASSERT_EQ(setrlimit(RLIMIT_AS, &small), 0);
  rlimit set{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &set), 0);
  if (set.rlim_cur != small.rlim_cur) GTEST_SKIP() << "the kernel, or an emulator, does not limit addresses";
  testing::internal::CaptureStderr();
  {
    ThreadPool thread_pool(64);
    ASSERT_EQ(setrlimit(RLIMIT_AS, &before), 0);
    EXPECT_LT(thread_pool.threads(), 64u);
    std::vector<std::atomic<int>> visits(1000);
    thread_pool.parallel_for(visits.size(), 7, [&](std::size_t first, std::size_t last, unsigned thread) {
      EXPECT_LT(thread, thread_pool.threads());
      for (std::size_t i = first; i < last; ++i) ++visits[i];
    });
    for (const auto& v : visits) EXPECT_EQ(v, 1);
  }
  EXPECT_NE(testing::internal::GetCapturedStderr().find("of 64 threads can be started"), std::string::npos);
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

/// A loop that is still running when a stop is requested skips pieces and throws. The next loop runs.
TEST(ThreadPool, InterruptedLoopEndsEarly) {
  for (const unsigned threads : {1u, 3u}) {
    ThreadPool thread_pool(threads);
    std::atomic<bool> stop{false};
    std::atomic<int> pieces{0};
    const auto loop = [&](int stop_after) {
      pieces = 0;
      thread_pool.parallel_for(10'000, 1, [&](std::size_t first, std::size_t last, unsigned) {
        pieces += static_cast<int>(last - first);
        if (pieces == stop_after) stop = true;
      });
    };
    thread_pool.interrupt_on([&] { return stop.load(); }, std::chrono::nanoseconds(0));
    EXPECT_THROW(loop(10), Interrupted);
    EXPECT_LT(pieces, 10 + static_cast<int>(threads));
    EXPECT_THROW(loop(0), Interrupted) << "nothing runs until the stop is withdrawn";
    thread_pool.interrupt_on({});
    loop(0);
    EXPECT_EQ(pieces, 10'000);
  }
}

/// A stop takes effect between any two items of a piece.
TEST(ThreadPool, InterruptedLoopEndsWithinAPiece) {
  for (const unsigned threads : {1u, 3u}) {
    ThreadPool thread_pool(threads);
    std::atomic<bool> stop{false};
    std::atomic<unsigned> items{0};
    thread_pool.interrupt_on([&] { return stop.load(); }, std::chrono::nanoseconds(0));
    EXPECT_THROW(thread_pool.parallel_for_each(1000, 1000, [&](std::size_t, unsigned) { ++items, stop = true; }),
                 Interrupted);
    EXPECT_EQ(items, 1u) << "one piece is one thread's";
  }
}

/// An item is not started if, taking as long as the last one, it would end after the patience expires.
TEST(ThreadPool, LongItemsDoNotStartAfterAStop) {
  constexpr std::chrono::milliseconds kPatience(50);
  ThreadPool thread_pool(1);
  std::atomic<bool> stop{false};
  int items = 0;
  thread_pool.interrupt_on([&] { return stop.load(); }, kPatience);
  EXPECT_THROW(thread_pool.parallel_for_each(10, 10,
                                             [&](std::size_t, unsigned) {
                                               ++items, stop = true;
                                               std::this_thread::sleep_for(kPatience);
                                             }),
               Interrupted);
  EXPECT_EQ(items, 1);
}

/// Loops that end within the patience complete.
TEST(ThreadPool, ShortLoopsCompleteAfterAStop) {
  ThreadPool thread_pool(2);
  thread_pool.interrupt_on([] { return true; }, std::chrono::hours(1));
  std::atomic<int> pieces{0};
  thread_pool.parallel_for(1'000, 1, [&](std::size_t, std::size_t, unsigned) { ++pieces; });
  EXPECT_EQ(pieces, 1'000);
}

}  // namespace
}  // namespace sf::base
