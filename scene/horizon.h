#pragma once
// How far beams from a sensor above a height field certainly do not meet it, by azimuth and elevation: starts for
// searches. One per scan.

#include <cstdint>

#include "scene/field_view.h"

namespace sf::scene {

/// A beam of azimuth in sector s that rises by more than slope[s][k] [m per horizontal metre] does not meet the field
/// within the horizontal distance reach[k]. Slopes grow with k.
struct Horizon {
  static constexpr std::int32_t kSectors = 64, kMostRings = 32;
  std::int32_t rings = 0;
  float reach[kMostRings];         ///< [m]; the last: the whole field, or the range
  std::int32_t level[kMostRings];  ///< of blocks that suit searches from there
  float slope[kSectors][kMostRings];
  float highest;  ///< largest of the slopes; beams that rise by more meet nothing

  /// Returns the sector of a direction as a fraction in [0, kSectors]: monotonic in the azimuth, in quadrants.
  static double sector_of(double x, double y);
};

/// @param view of a sensor over the field and certainly above it
void build_horizon(const FieldView& view, Horizon& out);

}  // namespace sf::scene
