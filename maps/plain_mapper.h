#pragma once
// Scans into a map, one at a time, on the host: the rule, and the reference that the device agrees with to the bit.
//
// The rule, after the thesis (4.4.3). Of each beam: its end is the cell of the point at its range. The line from the
// sensor's cell to it is free: with n = max(|dc|, |dr|) steps along the longer side (columns where they are equal),
// step i is (i * d / n) to the other side, rounded to the nearest cell, halves away from the sensor's cell (equations
// 11 and 12 in whole numbers). A range below range_max makes the end occupied; any other leaves it free. Within one
// scan occupied beats free; a later scan overwrites what it covers. Cells outside the map are left out, beams are not.

#include <cstdint>
#include <span>

#include "base/pose.h"
#include "maps/grid.h"

namespace sf::maps {

/// One scan as a mapper needs it.
struct ScanView {
  base::Pose X_WS;                 ///< of the sensor, as the robot believes
  std::span<const double> ranges;  ///< [m]; what is not a number is left out
  double fov = 0.0;                ///< [rad] bearings run from -fov/2 to +fov/2
  double range_min = 0.0;          ///< [m] what is nearer says nothing
  double range_max = 0.0;          ///< [m] nothing was met from here on
};

void add_scan(Grid& grid, const ScanView& scan);

}  // namespace sf::maps
