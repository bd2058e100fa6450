#pragma once
// Directions and times of a lidar's beams: of its rings, its rosette or its table.

#include <vector>

#include "sensors/lidar_beams.h"

namespace sf::sensors {

/// Rings and columns of a pattern, from the settings.
struct LidarLayout {
  std::vector<double> elevations;  ///< [rad] per channel
  std::vector<double> offsets;     ///< [rad] of the azimuths, per channel
  std::uint32_t columns = 0;
  double fov = 0.0;                         ///< [rad] in (0, 2 pi]
  bool rosette = false;                     ///< a circle of diameter `fov` instead of rings
  const world::BeamTable* table = nullptr;  ///< instead of all these
  double scan_time = 0.0;                   ///< [s] of a rolling scan; 0: all beams are cast at once
  double divergence = 0.0;                  ///< [rad] angle of a beam's cone
  std::uint32_t parts = 1;
  std::uint32_t skip = 1;  ///< casts every so many columns, and the last one

  bool has_rings() const { return !rosette && table == nullptr; }
  std::size_t beams() const { return table != nullptr ? table->rows.size() : elevations.size() * columns; }
  /// Returns numbers that are equal for equal beams.
  std::vector<double> description() const;
};

/// Returns the times [s] of all beams relative to the reading, that of the last column or of a table's last row; empty:
/// all are cast at once.
std::vector<double> times_of(const LidarLayout& layout);

/// Returns the beams with their pattern.
LidarBeams beams_of(const LidarLayout& layout);

}  // namespace sf::sensors
