#pragma once
// Sensors that stand where nothing moves: their last reading is given again instead of being taken.
//
// A reading without noise is a function of where its sensor stands and of where those are that come within its reach
// (`SensorSpec::dependency_radius`). A sensor is calm while none of these has moved since its last reading. The first
// reading that is taken in calm is kept, so fleets that drive copy nothing; those after it are given again, the same
// bytes.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "farm/pose_changes.h"
#include "farm/stored_reading.h"
#include "sensors/sensor_type.h"

namespace sf::farm {

/// The sensors of one kind.
class ReadingCache {
 public:
  /// @param rows the kind's. @param noise whether readings have their noise.
  ReadingCache(std::span<const sensors::SensorSpec> rows, bool noise);

  /// Takes the moves of a tick and everyone's poses after them, before its readings.
  void invalidate(PoseChanges& pose_changes, std::span<const base::Pose> poses);
  /// Whether the reading of sensor `row` is kept and would come out the same.
  bool has(std::uint32_t row) const { return validity_[row] == Validity::stored; }
  /// @pre keeps(row)
  const base::ReadingBlock& reading(std::uint32_t row) const { return stored_[row]->block(); }
  /// Sensor `row` has looked, where its mover stands in this tick.
  void store(std::uint32_t row, const base::ReadingBlock& block);

 private:
  enum class Validity : std::uint8_t {
    never,      ///< its readings depend on more than poses
    changed,    ///< something moved since its last reading, or there was none
    unchanged,  ///< nothing did
    stored,     ///< nothing did since the one before, and it is kept
  };
  /// The sensors of one mover.
  struct Carrier {
    std::uint32_t mover;
    std::uint32_t first, end;  ///< rows
    double reach;              ///< [m] from the mover's origin, of all of them
    bool depends_on_magnets;   ///< magnets count, bodies do not
    bool unchanged;            ///< some sensor is
  };
  void invalidate_all(Carrier& carrier);

  std::vector<Carrier> carriers_;
  std::vector<std::uint32_t> carrier_of_;               ///< per row
  std::vector<Validity> validity_;                      ///< per row
  std::vector<std::unique_ptr<StoredReading>> stored_;  ///< per row, where there was one to keep
  std::size_t unchanged_carriers_ = 0;
};

}  // namespace sf::farm
