#pragma once
// The farm's clock, as far as a robot can tell it from the timestamps of what comes.

#include <cstdint>
#include <optional>

namespace sf::netio {

/// The newest timestamp says how late the farm's clock is at the least; what came with the least delay says it best. So
/// the clock is behind by the delay of the quickest reading that came, and never ahead. After two seconds without
/// readings (kClientTimeout) the farm may have begun anew: the next reading sets the clock again. No clock is read
/// here.
class FarmClock {
 public:
  /// A reading that was measured at `time` [ns] by the farm's clock came at `came` [ns] by the robot's own.
  void update(std::int64_t time, std::int64_t arrival);

  /// [ns] of the farm when the robot's own clock says `own`; the same, before anything came.
  std::int64_t to_farm(std::int64_t own) const { return own + offset_; }
  /// The other way round.
  std::int64_t to_own(std::int64_t farm) const { return farm - offset_; }
  bool synchronised() const { return last_.has_value(); }

 private:
  std::int64_t offset_ = 0;           ///< [ns] farm's less own
  std::optional<std::int64_t> last_;  ///< [ns] when something came
};

}  // namespace sf::netio
