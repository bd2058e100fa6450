#pragma once
// How far a long job is: one line that rewrites itself on a terminal, nothing in a pipe.

#include <chrono>
#include <string>

namespace sf::apps {

class Progress {
 public:
  explicit Progress(std::string what);
  ~Progress();

  /// @param part [-] in [0, 1]. Draws at most ten times a second.
  void show(double part, const std::string& note = "");
  /// Clears a line that another process has left.
  static void clear();

 private:
  std::string what_;
  bool on_terminal_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point next_{};
};

}  // namespace sf::apps
