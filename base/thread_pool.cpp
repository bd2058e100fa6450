#include "base/thread_pool.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

namespace sf::base {

namespace {

constexpr int kTurnsAwake = 1000;  ///< about 20 us

void pause() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#endif
}

}  // namespace

struct ThreadPool::State {
  std::mutex lock;
  std::condition_variable wake;
  std::condition_variable done;
  std::vector<std::thread> threads;
  Job job{};
  std::size_t count = 0;
  std::size_t piece = 1;
  std::atomic<std::size_t> next{0};
  std::atomic<unsigned> round{0};
  unsigned busy = 0;  ///< threads that work on the job, without the caller
  bool open = false;  ///< true: a thread that wakes may still join the job
  bool stop = false;

  void work(unsigned thread) {
    for (;;) {
      const std::size_t first = next.fetch_add(piece);
      if (first >= count) return;
      job.call(job.body, first, std::min(first + piece, count), thread);
    }
  }

  /// Spins before it sleeps: the next job of a tick usually follows sooner than a sleeping thread wakes.
  void wait_awake(unsigned seen) const {
    for (int turn = 0; turn < kTurnsAwake && round.load(std::memory_order_relaxed) == seen; ++turn) pause();
  }

  void serve(unsigned thread) {
    unsigned seen = 0;
    for (;;) {
      wait_awake(seen);
      {
        std::unique_lock guard(lock);
        wake.wait(guard, [&] { return stop || (open && round != seen); });
        if (stop) return;
        seen = round;
        ++busy;
      }
      work(thread);
      const std::scoped_lock guard(lock);
      if (--busy == 0) done.notify_one();
    }
  }
};

ThreadPool::ThreadPool(unsigned threads) : state_(std::make_unique<State>()) {
  const unsigned wanted = threads > 0 ? threads : std::max(1u, std::thread::hardware_concurrency());
  for (unsigned i = 1; i < wanted; ++i) state_->threads.emplace_back([this, i] { state_->serve(i); });
}

ThreadPool::~ThreadPool() {
  {
    const std::scoped_lock guard(state_->lock);
    state_->stop = true;
  }
  state_->wake.notify_all();
  for (std::thread& thread : state_->threads) thread.join();
}

unsigned ThreadPool::threads() const { return static_cast<unsigned>(state_->threads.size()) + 1; }

void ThreadPool::run_job(std::size_t count, std::size_t piece, Job job) {
  State& s = *state_;
  if (s.threads.empty() || count <= piece) {
    if (count > 0) job.call(job.body, 0, count, 0);
    return;
  }
  {
    const std::scoped_lock guard(s.lock);
    s.job = job;
    s.count = count;
    s.piece = std::max<std::size_t>(1, piece);
    s.next = 0;
    s.open = true;
    ++s.round;
  }
  s.wake.notify_all();
  s.work(0);
  // All pieces are taken. Threads that have not woken yet are not waited for.
  std::unique_lock guard(s.lock);
  s.open = false;
  s.done.wait(guard, [&] { return s.busy == 0; });
}

}  // namespace sf::base
