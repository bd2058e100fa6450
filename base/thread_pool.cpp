#include "base/thread_pool.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <ctime>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "base/error.h"

namespace sf::base {

namespace {

constexpr int kTurnsAwake = 12000;  ///< about 180 us, which covers the serial parts of a tick of 1 000 robots

/// [ns] time when this thread last checked for a stop or began a loop.
thread_local std::int64_t looked_at = 0;

/// Returns the steady clock [ns] to within 4 ms. Cheap, because it is read before each item of a loop.
std::int64_t coarse_time() {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC_COARSE, &time);
  return 1'000'000'000 * static_cast<std::int64_t>(time.tv_sec) + time.tv_nsec;
}

void pause() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#endif
}

/// Pieces of a loop assigned to one thread, which takes them from the front. Threads that have finished their own
/// pieces take them from the back.
class alignas(64) Share {
 public:
  void assign(std::uint32_t first, std::uint32_t end) { ends_ = std::uint64_t{end} << 32 | first; }
  /// @return false when no piece is left
  bool take(bool from_front, std::size_t& piece) {
    for (std::uint64_t ends = ends_;;) {
      const auto first = static_cast<std::uint32_t>(ends), end = static_cast<std::uint32_t>(ends >> 32);
      if (first >= end) return false;
      piece = from_front ? first : end - 1;
      if (ends_.compare_exchange_weak(ends, from_front ? ends + 1 : ends - (std::uint64_t{1} << 32))) return true;
    }
  }

 private:
  std::atomic<std::uint64_t> ends_{0};  ///< first piece in the lower half, end of the pieces in the upper half
};

}  // namespace

// Every loop is divided into the same shares: the data written by a loop over robots is then still in the caches of the
// core that reads it in the next loop.
struct ThreadPool::State {
  std::mutex lock;
  std::condition_variable wake;
  std::condition_variable done;
  std::vector<std::thread> threads;
  Job job{};
  std::size_t count = 0;
  std::size_t piece = 1;
  std::vector<Share> shares;  ///< per thread
  std::atomic<unsigned> round{0};
  std::atomic<unsigned> busy{0};  ///< threads working on the job, excluding the caller
  bool open = false;              ///< true while a thread that wakes may still join the job
  bool stop = false;
  std::exception_ptr failure;                   ///< first exception thrown by a piece of the job
  std::function<bool()> interrupt;              ///< `stop` of `interrupt_on`
  std::chrono::nanoseconds patience{};          ///< of `interrupt_on`
  std::atomic<std::int64_t> interrupted_at{0};  ///< [ns] `coarse_time` of the last check before `interrupt` returned
                                                ///< true; 0: it still returns false
  std::atomic<bool> given_up{false};            ///< the job skips pieces

  void work(unsigned thread) {
    if (interrupt) looked_at = coarse_time();
    for (std::size_t k = 0, at = 0; k < shares.size(); ++k)
      while (shares[(thread + k) % shares.size()].take(k == 0, at))
        if (!gives_up()) call(at, thread);
  }

  /// Keeps exceptions, such as out of memory, until the end of the loop, because other threads still use its data.
  void call(std::size_t at, unsigned thread) {
    try {
      job.call(job.body, at * piece, std::min((at + 1) * piece, count), thread);
    } catch (...) {
      const std::scoped_lock guard(lock);
      if (!failure) failure = std::current_exception();
    }
  }

  bool gives_up() {
    if (!interrupt) return false;
    const std::int64_t now = coarse_time(), before = std::exchange(looked_at, now);
    if (!interrupt()) return false;
    std::int64_t since = 0;
    if (interrupted_at.compare_exchange_strong(since, before)) since = before;
    if (now - since + (now - before) >= patience.count()) given_up = true;
    return given_up;
  }

  /// Divides a loop into shares that differ by at most one piece.
  void divide() {
    const std::size_t pieces = (count + piece - 1) / piece, n = shares.size();
    SF_CHECK(pieces <= 0xFFFFFFFFu, std::to_string(pieces) + " pieces");
    for (std::size_t i = 0; i < n; ++i)
      shares[i].assign(static_cast<std::uint32_t>(i * pieces / n), static_cast<std::uint32_t>((i + 1) * pieces / n));
  }

  /// Spins before a thread sleeps. The next job of a tick and the end of a job usually arrive before the thread could
  /// wake up.
  template <class Condition>
  static void spin_until(Condition condition) {
    for (int turn = 0; turn < kTurnsAwake && !condition(); ++turn) pause();
  }

  void serve(unsigned thread) {
    unsigned seen = 0;
    for (;;) {
      spin_until([&] { return round != seen; });
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

namespace {

/// Prints the note once per process.
void note_fewer_threads(unsigned got, unsigned wanted) {
  static std::atomic<bool> noted{false};
  if (!noted.exchange(true))
    std::fprintf(stderr,
                 "sensorfarm: only %u of %u threads can be started, so it runs slower: the limits of processes (ulimit "
                 "-u) or of memory (ulimit -v) allow no more\n",
                 got, wanted);
}

}  // namespace

ThreadPool::ThreadPool(unsigned threads) : state_(std::make_unique<State>()) {
  const unsigned wanted = threads > 0 ? threads : std::max(1u, std::thread::hardware_concurrency());
  state_->shares = std::vector<Share>(wanted);
  state_->threads.reserve(wanted);
  try {
    for (unsigned i = 1; i < wanted; ++i) state_->threads.emplace_back([this, i] { state_->serve(i); });
  } catch (const std::system_error&) {  // a process or memory limit; `threads()` returns the number that started
    note_fewer_threads(this->threads(), wanted);
  }
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

void ThreadPool::interrupt_on(std::function<bool()> stop, std::chrono::nanoseconds patience) {
  state_->interrupt = std::move(stop);
  state_->patience = patience;
  state_->interrupted_at = 0;
  state_->given_up = false;
}

bool ThreadPool::gives_up() { return state_->gives_up(); }

void ThreadPool::run_job(std::size_t count, std::size_t piece, Job job) {
  State& s = *state_;
  if (s.threads.empty() || count <= piece) {
    const std::size_t part = s.interrupt ? std::max<std::size_t>(1, piece) : count;
    if (s.interrupt) looked_at = coarse_time();
    for (std::size_t first = 0; first < count; first += part) {
      if (s.gives_up()) throw Interrupted();
      job.call(job.body, first, std::min(first + part, count), 0);
    }
    if (s.given_up) throw Interrupted();
    return;
  }
  {
    const std::scoped_lock guard(s.lock);
    s.job = job;
    s.count = count;
    s.piece = std::max<std::size_t>(1, piece);
    s.divide();
    s.open = true;
    ++s.round;
  }
  s.wake.notify_all();
  s.work(0);
  // All pieces are taken. Does not wait for threads that have not woken up yet.
  {
    const std::scoped_lock guard(s.lock);
    s.open = false;
  }
  s.spin_until([&] { return s.busy == 0; });
  std::unique_lock guard(s.lock);
  s.done.wait(guard, [&] { return s.busy == 0; });
  if (s.failure) std::rethrow_exception(std::exchange(s.failure, nullptr));
  if (s.given_up) throw Interrupted();
}

}  // namespace sf::base
