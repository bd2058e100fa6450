#include "base/parallel.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

namespace sf::base {

struct Workers::State {
  std::mutex lock;
  std::condition_variable wake;
  std::condition_variable done;
  std::vector<std::thread> threads;
  Job job{};
  std::size_t count = 0;
  std::size_t piece = 1;
  std::atomic<std::size_t> next{0};
  unsigned round = 0;
  unsigned busy = 0;
  bool stop = false;

  void work(unsigned thread) {
    for (;;) {
      const std::size_t first = next.fetch_add(piece);
      if (first >= count) return;
      job.call(job.body, first, std::min(first + piece, count), thread);
    }
  }

  void serve(unsigned thread) {
    unsigned seen = 0;
    for (;;) {
      {
        std::unique_lock guard(lock);
        wake.wait(guard, [&] { return stop || round != seen; });
        if (stop) return;
        seen = round;
      }
      work(thread);
      const std::scoped_lock guard(lock);
      if (--busy == 0) done.notify_one();
    }
  }
};

Workers::Workers(unsigned threads) : state_(std::make_unique<State>()) {
  const unsigned wanted = threads > 0 ? threads : std::max(1u, std::thread::hardware_concurrency());
  for (unsigned i = 1; i < wanted; ++i) state_->threads.emplace_back([this, i] { state_->serve(i); });
}

Workers::~Workers() {
  {
    const std::scoped_lock guard(state_->lock);
    state_->stop = true;
  }
  state_->wake.notify_all();
  for (std::thread& thread : state_->threads) thread.join();
}

unsigned Workers::threads() const { return static_cast<unsigned>(state_->threads.size()) + 1; }

void Workers::run_job(std::size_t count, std::size_t piece, Job job) {
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
    s.busy = static_cast<unsigned>(s.threads.size());
    ++s.round;
  }
  s.wake.notify_all();
  s.work(0);
  std::unique_lock guard(s.lock);
  s.done.wait(guard, [&] { return s.busy == 0; });
}

}  // namespace sf::base
