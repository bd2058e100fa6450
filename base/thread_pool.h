#pragma once
// Fixed-size thread pool. Results of a loop must not depend on its partition.

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <stdexcept>
#include <type_traits>

namespace sf::base {

/// Work was stopped before its end, as its user asked.
struct Interrupted : std::runtime_error {
  Interrupted() : std::runtime_error("interrupted") {}
};

/// A request to stop takes effect within this time. Loops are given up after half of it, and processes whose calls of
/// users' code go on end shortly before it is over (apps/processes/supervision.h).
inline constexpr std::chrono::milliseconds kStopLimit{500};

/// Threads that run the pieces of a loop. One caller at a time.
class ThreadPool {
 public:
  /// @param threads number of threads in a loop, including the caller; 0: one per core of the machine. Where the system
  /// starts no more, there are fewer, with a note on standard error.
  explicit ThreadPool(unsigned threads = 0);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  unsigned threads() const;

  /// From now on a loop is given up where its next piece, if it takes as long as the last, ends later than `patience`
  /// after `stop` returns true: it leaves pieces out, and `parallel_for` throws Interrupted. The data of the loop are
  /// then of no use. Shorter loops end whole. @param stop called by all threads, before each piece; empty: never
  void interrupt_on(std::function<bool()> stop, std::chrono::nanoseconds patience = kStopLimit / 2);

  /// Calls `body(first, last, thread)` on pieces of [0, count) and returns when all are done; `thread` < threads(). The
  /// assignment of pieces to threads varies, so results of `body` must not depend on it. Allocates nothing.
  /// @throws what a piece threw first, once all pieces are done
  template <class Body>
  void parallel_for(std::size_t count, std::size_t piece, Body&& body) {
    using Plain = std::remove_reference_t<Body>;
    run_job(count, piece,
            {const_cast<void*>(static_cast<const void*>(&body)),
             [](void* b, std::size_t first, std::size_t last, unsigned thread) {
               (*static_cast<Plain*>(b))(first, last, thread);
             }});
  }

  /// Calls `body(item, thread)` for each item of [0, count), as `parallel_for` does for pieces. `stop` of
  /// `interrupt_on` is called before each item: for items that may take long.
  template <class Body>
  void parallel_for_each(std::size_t count, std::size_t piece, Body&& body) {
    parallel_for(count, piece, [&](std::size_t first, std::size_t last, unsigned thread) {
      for (std::size_t i = first; i < last && !gives_up(); ++i) body(i, thread);
    });
  }

 private:
  struct Job {
    void* body;
    void (*call)(void* body, std::size_t first, std::size_t last, unsigned thread);
  };
  void run_job(std::size_t count, std::size_t piece, Job job);
  bool gives_up();
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sf::base
