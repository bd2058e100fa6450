#pragma once
// Draws a sector between two bearings up to a range: fields of view of sensors, beams of emitters.

#include <cstdint>

#include "base/pose.h"
#include "viz/axes.h"

namespace sf::viz {

struct SectorStyle {
  std::uint32_t color = 0;  ///< 0xAARRGGBB
  double inside = 0.0;      ///< opacity in [0, 1]
  double border = 0.0;      ///< opacity in [0, 1]
  int sides = 32;           ///< segments of the arc
};

/// @param from, to [rad] bearings in the frame F; a full turn is a circle
/// @param reach [m]
void draw_view_sector(Axes& axes, const base::Pose& X_WF, double from, double to, double reach,
                      const SectorStyle& look);

}  // namespace sf::viz
