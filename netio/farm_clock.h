#pragma once
// Estimates the farm's clock from the timestamps of readings.

#include <cstdint>
#include <optional>

namespace sf::netio {

/// The estimate is the largest difference between a reading's timestamp and its arrival. It lags the farm's clock by
/// the delay of the fastest reading and is never ahead. After two seconds without readings (kSenderTimeout) the farm
/// may have restarted, so the next reading sets the clock again. Reads no clock.
class FarmClock {
 public:
  /// Updates the estimate with a reading that was measured at `time` [ns] on the farm's clock and arrived at `arrival`
  /// [ns] on the robot's clock.
  void update(std::int64_t time, std::int64_t arrival);

  /// Returns the farm's time [ns] at the robot's time `own`. The two are equal before the first reading.
  std::int64_t to_farm(std::int64_t own) const { return own + offset_; }
  /// The inverse of `to_farm`.
  std::int64_t to_own(std::int64_t farm) const { return farm - offset_; }
  bool synchronised() const { return last_.has_value(); }

 private:
  std::int64_t offset_ = 0;           ///< [ns] farm's time minus robot's time
  std::optional<std::int64_t> last_;  ///< [ns] last arrival
};

}  // namespace sf::netio
