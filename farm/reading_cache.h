#pragma once
// Caches readings of sensors near which nothing moves. A cached reading is reused instead of measured again.
//
// A reading without noise depends only on its sensor's pose and on the poses of the movers within
// `SensorSpec::dependency_radius`. A cached reading is valid until one of these changes. Only the second reading
// without a change in between is stored, so sensors of driving robots copy nothing. Later readings reuse it, byte for
// byte.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "farm/pose_changes.h"
#include "farm/stored_reading.h"
#include "sensors/sensor_type.h"

namespace sf::farm {

/// Cache for the sensors of one type.
class ReadingCache {
 public:
  /// @param rows of the type @param noise whether readings carry noise
  ReadingCache(std::span<const sensors::SensorSpec> rows, bool noise);

  /// Invalidates readings affected by the moves of a tick. Call it with the states after the moves, before the
  /// readings.
  void invalidate(PoseChanges& pose_changes, std::span<const base::Report> states);
  /// Returns whether a valid reading of sensor `row` is stored.
  bool has(std::uint32_t row) const { return validity_[row] == Validity::stored; }
  /// @pre has(row)
  const base::ReadingBlock& reading(std::uint32_t row) const { return stored_[row]->block(); }
  /// Offers a new reading of sensor `row`, measured at its mover's current pose.
  void store(std::uint32_t row, const base::ReadingBlock& block);

 private:
  enum class Validity : std::uint8_t {
    never,      ///< not cacheable: its readings depend on more than poses
    changed,    ///< a dependency moved since its last reading, or there was none
    unchanged,  ///< no dependency moved since its last reading, which is not stored
    stored,     ///< no dependency moved since its last reading, which is stored
  };
  /// The sensors of one mover.
  struct Carrier {
    std::uint32_t mover;
    std::uint32_t first, end;  ///< rows
    double reach;              ///< [m] from the mover's origin, the largest of its sensors
    bool depends_on_magnets;   ///< the sensors depend on magnets, not on bodies
    bool unchanged;            ///< at least one sensor is `unchanged` or `stored`
  };
  void invalidate_all(Carrier& carrier);

  std::vector<Carrier> carriers_;
  std::vector<std::uint32_t> carrier_of_;               ///< per row
  std::vector<Validity> validity_;                      ///< per row
  std::vector<std::unique_ptr<StoredReading>> stored_;  ///< per row; null without a reading
  std::size_t unchanged_carriers_ = 0;
};

}  // namespace sf::farm
