#pragma once
// Check points of a run in DIR/checkpoints: hashes of its readings and states, from time to time. A run that was cut
// short is computed again from its start, which is right for every controller and sensor whatever state they keep, and
// proves at each check point that it is the same run.

#include <cstdint>
#include <map>
#include <span>
#include <string>

#include "base/report.h"

namespace sf::apps {

class Checkpoints {
 public:
  /// @param run hash of all that the run's results depend on @param every [tick] 0: none are added
  /// @param resume compare with those in the file, else begin it anew
  /// @throws base::InputError where there are none to resume, they are another run's, or the file cannot be written
  Checkpoints(const std::string& folder, std::uint64_t run, std::uint64_t every, bool resume);

  /// After each tick. @param ticks so far @param readings hash of all readings so far
  /// @throws base::InputError where the run differs from the one that is resumed
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
  std::map<std::uint64_t, Point> known_;  ///< by tick, of the run that is resumed
};

}  // namespace sf::apps
