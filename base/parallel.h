#pragma once
// Two cores are two cores: the same loop on all of them, with results that do not depend on how it was split.

#include <cstddef>
#include <functional>
#include <memory>

namespace sf::base {

/// A few threads that wait for loops to run. One caller at a time.
class Workers {
 public:
  /// @param threads how many run a loop together, the caller among them; 0: as many as the machine has.
  explicit Workers(unsigned threads = 0);
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  unsigned threads() const;

  /// Calls `body(first, last, thread)` on pieces of [0, count) until all are done; `thread` < threads(). Pieces go to
  /// whoever is free, so `body` must not care. Does not allocate.
  void run(std::size_t count, std::size_t piece, const std::function<void(std::size_t, std::size_t, unsigned)>& body);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sf::base
