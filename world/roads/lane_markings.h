#pragma once
// The paint of a road network: what a lane edge sensor sees.
//
// The middle of a line lies on the lane's edge. Two solid lines of `double_yellow` stand on either side of it, one
// line's width apart. Dashes begin with the lane, each is a stripe of its own, and the last is as long as there is lane
// left. Stop lines and the sides and ends of parking spots are white. Perimeters of zones are not painted, and no edge
// is that has no boundary. A line between two lanes is painted by both of them where both say so.
//
// Sizes, unless the sidecar says otherwise, times the scale (FHWA, "Manual on Uniform Traffic Control Devices", 2009:
// 3A.06 longitudinal lines 4 to 6 in, double lines with a discernible gap, broken lines 10 ft with gaps of 30 ft; 3B.16
// stop lines 12 to 24 in): lines 4 in, dashes 10 ft, gaps 30 ft, stop lines 12 in.

#include <vector>

#include "world/roads/network.h"

namespace sf::world {

inline constexpr double kFoot = 0.3048;  ///< [m]
inline constexpr double kInch = 0.0254;  ///< [m]

inline constexpr std::uint32_t kYellowPaint = 0xFFF2B800u;  ///< 0xAARRGGBB
inline constexpr std::uint32_t kWhitePaint = 0xFFFFFFFFu;

/// @throws base::InputError when there are more than a million stripes.
std::vector<LaneMarking> lane_markings_of(const RoadNetwork& network);

}  // namespace sf::world
