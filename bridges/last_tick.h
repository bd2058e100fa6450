#pragma once
// The newest tick: what a viewer is shown that connects, or chooses another robot, while the run is paused.

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "base/tick_record.h"

namespace sf::bridges {

/// One thread.
class LastTick {
 public:
  /// Copies the tick. @param with_readings true: those that it lacks are kept from earlier ticks, unless time went
  /// back; false: readings, which are the largest part, are left out and forgotten
  void store(const base::TickRecord& tick, bool with_readings);
  bool empty() const { return reports_.empty(); }
  std::int64_t time() const { return tick_.time; }
  /// Spans live until the next `store`.
  const base::TickRecord& record();

 private:
  struct Stored {
    base::ReadingBlock block;
    std::vector<double> values;
    std::vector<base::QualityFlag> quality;
  };
  void store(const base::ReadingBlock& reading);

  base::TickRecord tick_;
  std::vector<base::Report> reports_;
  std::vector<base::Twist> commands_;
  std::vector<std::uint8_t> contacts_;
  std::vector<base::StateQuality> qualities_;
  std::vector<base::LightStatus> lights_;
  std::unordered_map<std::uint64_t, std::size_t> rows_;  ///< of `readings_`, by mover, type and sensor
  std::vector<Stored> readings_;
  std::vector<base::ReadingBlock> blocks_;
};

}  // namespace sf::bridges
