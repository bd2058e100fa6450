#pragma once
// The newest tick, for viewers that connect or select another robot while the run is paused.

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "base/tick_record.h"

namespace sf::bridges {

/// Not thread-safe.
class LastTick {
 public:
  /// Copies the tick.
  /// @param with_readings true: keeps readings of earlier ticks that this tick lacks, unless time has gone back; false:
  /// drops all readings, which are the largest part
  void store(const base::TickRecord& tick, bool with_readings);
  bool empty() const { return reports_.empty(); }
  std::int64_t time() const { return tick_.time; }
  /// Spans are valid until the next `store`.
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
