#pragma once
// Fixed-size thread pool. Results of a loop must not depend on its partition.

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <stdexcept>
#include <type_traits>

namespace sf::base {

/// Thrown when work is stopped early at the user's request.
struct Interrupted : std::runtime_error {
  Interrupted() : std::runtime_error("interrupted") {}
};

/// A stop request takes effect within this time. Loops are abandoned after half of it. Processes still inside users'
/// code end shortly before it expires (apps/processes/supervision.h).
inline constexpr std::chrono::milliseconds kStopLimit{500};

/// Threads that run the pieces of a loop. One caller at a time.
class ThreadPool {
 public:
  /// @param threads number of threads in a loop, including the caller; 0: one per core of the machine. If the system
  /// cannot start that many, the pool has fewer and prints a note on standard error.
  explicit ThreadPool(unsigned threads = 0);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  unsigned threads() const;

  /// Makes later loops interruptible. A loop is abandoned if its next piece, assuming that it takes as long as the last
  /// one, would end later than `patience` after `stop` returns true. It then skips pieces, `parallel_for` throws
  /// Interrupted, and the data of the loop is unusable. Shorter loops complete. @param stop called by all threads
  /// before each piece; empty: never interrupts
  void interrupt_on(std::function<bool()> stop, std::chrono::nanoseconds patience = kStopLimit / 2);

  /// Calls `body(first, last, thread)` on pieces of [0, count) and returns when all are done; `thread` < threads(). The
  /// assignment of pieces to threads varies, so results of `body` must not depend on it. Does not allocate.
  /// @throws the first exception thrown by a piece, once all pieces are done
  template <class Body>
  void parallel_for(std::size_t count, std::size_t piece, Body&& body) {
    using Plain = std::remove_reference_t<Body>;
    run_job(count, piece,
            {const_cast<void*>(static_cast<const void*>(&body)),
             [](void* b, std::size_t first, std::size_t last, unsigned thread) {
               (*static_cast<Plain*>(b))(first, last, thread);
             }});
  }

  /// Calls `body(item, thread)` for each item of [0, count), with the contract of `parallel_for`. For items that may
  /// take long: checks `stop` of `interrupt_on` before each item.
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
