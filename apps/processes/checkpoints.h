#pragma once
// Check points of a run in DIR/checkpoints: periodic hashes of its readings and states. An interrupted run is
// recomputed from its start, which works for every controller and sensor regardless of their internal state. Each check
// point verifies that it is the same run.

#include <cstdint>
#include <map>
#include <span>
#include <string>

#include "base/report.h"

namespace sf::apps {

class Checkpoints {
 public:
  /// @param run hash of everything that the run's results depend on @param every [tick] 0: adds none
  /// @param resume compares with the checkpoints in the file; otherwise starts a new file
  /// @throws base::InputError if there is nothing to resume, the checkpoints belong to another run, or the file cannot
  /// be written
  Checkpoints(const std::string& folder, std::uint64_t run, std::uint64_t every, bool resume);

  /// Call after each tick. @param ticks so far @param readings hash of all readings so far
  /// @throws base::InputError if the run differs from the resumed one
  void update(std::uint64_t ticks, std::uint64_t readings, std::span<const base::Report> reports);

 private:
  struct Point {
    std::uint64_t readings = 0, states = 0;
    friend bool operator==(const Point&, const Point&) = default;
  };
  void read(const std::string& head);
  void append(const std::string& line, bool anew);

  std::string file_;
  std::uint64_t every_;
  std::map<std::uint64_t, Point> known_;  ///< by tick, of the resumed run
};

}  // namespace sf::apps
