#pragma once
// Output of ranges without a return, in the form that the user selects.

#include <span>
#include <vector>

#include "base/reading.h"
#include "sensors/sensor_set.h"

namespace sf::server {

/// Replaces the range of each beam without a return by infinity, if enabled.
class NoReturnFilter {
 public:
  /// @param infinite false: readings pass unchanged. `sensor_set` must outlive the filter.
  NoReturnFilter(const sensors::SensorSet& sensor_set, bool infinite) : sensor_set_(sensor_set), infinite_(infinite) {}
  /// Returns the readings themselves or modified copies, valid until the next call.
  std::span<const base::ReadingBlock> apply(std::span<const base::ReadingBlock> readings);

 private:
  const sensors::SensorSet& sensor_set_;
  bool infinite_;
  std::vector<base::ReadingBlock> blocks_;
  std::vector<double> ranges_;
};

}  // namespace sf::server
