#pragma once
// The lane markings of a road network, as measured by lane edge sensors.
//
// The centre of a line is on the lane's edge. The two solid lines of `double_yellow` are on both sides of the edge, one
// line width apart. Dashes start at the start of the lane, each dash is a separate marking, and the last one ends with
// the lane. Stop lines and the sides and ends of parking spots are white. Perimeters of zones and edges without a
// boundary have no markings. A line between two lanes is added twice if both lanes specify it.
//
// Default sizes, times the scale, unless the sidecar sets others (FHWA, "Manual on Uniform Traffic Control Devices",
// 2009: 3A.06 longitudinal lines 4 to 6 in, double lines with a discernible gap, broken lines 10 ft with gaps of 30 ft;
// 3B.16 stop lines 12 to 24 in): lines 4 in, dashes 10 ft, gaps 30 ft, stop lines 12 in.

#include <vector>

#include "world/roads/network.h"

namespace sf::world {

inline constexpr double kFoot = 0.3048;  ///< [m]
inline constexpr double kInch = 0.0254;  ///< [m]

inline constexpr std::uint32_t kYellowPaint = 0xFFF2B800u;  ///< 0xAARRGGBB
inline constexpr std::uint32_t kWhitePaint = 0xFFFFFFFFu;

/// @param heights out, if not null: of each marking those of its lane, from the lowest to the highest way-point
/// @throws base::InputError if there are more than a million markings
std::vector<LaneMarking> lane_markings_of(const RoadNetwork& network, std::vector<MarkingHeights>* heights = nullptr);

}  // namespace sf::world
