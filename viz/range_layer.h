#pragma once
// Readings of ranges on a picture: scans of lasers, cones of sonar and infrared.

#include <vector>

#include "record/run_info.h"
#include "viz/axes.h"

namespace sf::viz {

/// A reading as it is drawn.
struct RangeReading {
  const record::SensorInfo* sensor = nullptr;  ///< outlives it
  base::Pose X_WS;                             ///< the sensor at the measurement, so that echoes lie on surfaces
  std::vector<double> values;                  ///< as in base::ReadingBlock
};

/// Whether readings of this sensor are scans or ranges of cones.
bool has_ranges(const record::RunInfo& info, const record::SensorInfo& sensor);

/// The area in view, and a dot where each beam met a surface. Of cones: the sector up to the echo, fainter without one.
/// @param reading of a sensor that `has_ranges`
void draw_ranges(Axes& axes, const RangeReading& reading);

}  // namespace sf::viz
