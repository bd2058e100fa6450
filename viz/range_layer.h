#pragma once
// Drawing of range readings: laser scans, cones of sonar and infrared sensors.

#include <vector>

#include "record/run_info.h"
#include "viz/axes.h"

namespace sf::viz {

/// A reading to draw.
struct RangeReading {
  const record::SensorInfo* sensor = nullptr;  ///< must outlive this
  base::Pose X_WS;             ///< pose of the sensor at the measurement, so that echoes lie on surfaces
  std::vector<double> values;  ///< as in base::ReadingBlock
  base::Tilt tilt{};           ///< of a scan; its beams are drawn as seen from above
};

/// True if readings of this sensor are scans or ranges of cones.
bool has_ranges(const record::RunInfo& info, const record::SensorInfo& sensor);

/// Draws the visible area and a dot where each beam hit a surface. For cones, draws the sector up to the echo, or a
/// fainter one if there is none.
/// @param reading of a sensor that `has_ranges`
void draw_ranges(Axes& axes, const RangeReading& reading);

}  // namespace sf::viz
