#pragma once
// Two cores are two cores: the same loop on all of them, with results that do not depend on how it was split.

#include <cstddef>
#include <memory>
#include <type_traits>

namespace sf::base {

/// A few threads that wait for loops to run. One caller at a time.
class ThreadPool {
 public:
  /// @param threads how many run a loop together, the caller among them; 0: as many as the machine has.
  explicit ThreadPool(unsigned threads = 0);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  unsigned threads() const;

  /// Calls `body(first, last, thread)` on pieces of [0, count) until all are done; `thread` < threads(). Pieces go to
  /// whoever is free, so `body` must not care. Does not allocate.
  template <class Body>
  void parallel_for(std::size_t count, std::size_t piece, Body&& body) {
    using Plain = std::remove_reference_t<Body>;
    run_job(count, piece,
            {const_cast<void*>(static_cast<const void*>(&body)),
             [](void* b, std::size_t first, std::size_t last, unsigned thread) {
               (*static_cast<Plain*>(b))(first, last, thread);
             }});
  }

 private:
  struct Job {
    void* body;
    void (*call)(void* body, std::size_t first, std::size_t last, unsigned thread);
  };
  void run_job(std::size_t count, std::size_t piece, Job job);
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sf::base
