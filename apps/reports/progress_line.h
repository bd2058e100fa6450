#pragma once
// Progress of a long job: one line that rewrites itself on a terminal, nothing in a pipe.

#include <chrono>
#include <string>

namespace sf::apps {

class Progress {
 public:
  explicit Progress(std::string what);
  ~Progress();

  /// Draws at most ten times a second.
  /// @param part [-] finished part in [0, 1]
  void show(double part, const std::string& note = "");
  /// Clears a line left by another process.
  static void clear();

 private:
  std::string what_;
  bool on_terminal_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point next_{};
};

}  // namespace sf::apps
