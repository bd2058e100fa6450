#pragma once
// Lane edge sensors in plain C++: traverses the same raster, or a uniform grid of exact faces, and uses the same fit,
// one sensor after another.

#include "base/pose.h"
#include "bench/grid.h"
#include "sensors/lane_markings/marking_raster.h"
#include "sensors/laneedge.h"

namespace sf::bench {

/// Data shared by all sensors of a scene.
struct LaneJob {
  const SegmentGrid* grid = nullptr;               ///< of exact faces; null: uses `raster`
  const sensors::MarkingRaster* raster = nullptr;  ///< of the markings
  std::uint32_t paint_tag = 0;                     ///< of the raster
  Walk walk = nullptr;                             ///< of the grid, from the same build
  std::vector<glm::dvec2> beams;                   ///< unit vectors in the sensor's frame
  std::vector<double> directions;                  ///< the same as a flat array
  std::vector<double> grains;
  double range_max = 1.0;  ///< [m]
};

/// @param row the sensor's data for the fit
using LaneRead = void (*)(const LaneJob& job, const sensors::EdgeRow& row, const base::Pose& X_WS,
                          sensors::EdgeReading& out);

/// One source compiled twice: for any x86-64 processor, and for the build machine.
void read_lane_portable(const LaneJob& job, const sensors::EdgeRow& row, const base::Pose& X_WS,
                        sensors::EdgeReading& out);
void read_lane_native(const LaneJob& job, const sensors::EdgeRow& row, const base::Pose& X_WS,
                      sensors::EdgeReading& out);

}  // namespace sf::bench
