#pragma once
// Lane edge sensors in plain C++: the same walk over the same raster, or a uniform grid of exact faces, and the same
// fit, one sensor after another.

#include "base/pose.h"
#include "bench/grid.h"
#include "sensors/lane_markings/marking_raster.h"
#include "sensors/laneedge.h"

namespace sf::bench {

/// What all sensors of a scene share.
struct LaneJob {
  const SegmentGrid* grid = nullptr;               ///< of exact faces, or
  const sensors::MarkingRaster* raster = nullptr;  ///< of paint
  std::uint32_t paint_tag = 0;                     ///< of the raster
  Walk walk = nullptr;                             ///< of the grid, of the same build
  std::vector<glm::dvec2> beams;                   ///< unit, in the sensor's frame
  std::vector<double> directions;                  ///< the same, number by number
  std::vector<double> grains;
  double range_max = 1.0;  ///< [m]
};

/// @param row what the fit needs of this sensor
using LaneRead = void (*)(const LaneJob& job, const sensors::EdgeRow& row, const base::Pose& X_WS,
                          sensors::EdgeReading& out);

/// The same source built twice: for any x86-64, and for the very processor it was built on.
void read_lane_portable(const LaneJob& job, const sensors::EdgeRow& row, const base::Pose& X_WS,
                        sensors::EdgeReading& out);
void read_lane_native(const LaneJob& job, const sensors::EdgeRow& row, const base::Pose& X_WS,
                      sensors::EdgeReading& out);

}  // namespace sf::bench
