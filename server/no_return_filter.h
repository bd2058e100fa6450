#pragma once
// Ranges without a return, as the user wants them to read.

#include <span>
#include <vector>

#include "base/reading.h"
#include "sensors/sensor_set.h"

namespace sf::server {

/// Replaces the range of each beam without a return by infinity, where that is asked for.
class NoReturnFilter {
 public:
  /// @param infinite false: readings pass unchanged. `sensor_set` must outlive the filter.
  NoReturnFilter(const sensors::SensorSet& sensor_set, bool infinite) : sensor_set_(sensor_set), infinite_(infinite) {}
  /// The same readings, or copies. They live until the next call.
  std::span<const base::ReadingBlock> apply(std::span<const base::ReadingBlock> readings);

 private:
  const sensors::SensorSet& sensor_set_;
  bool infinite_;
  std::vector<base::ReadingBlock> blocks_;
  std::vector<double> ranges_;
};

}  // namespace sf::server
