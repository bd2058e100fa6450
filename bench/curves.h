#pragma once
// Cost of a tick over the number of robots at constant density, and over the number of segments of a city with 100
// robots.

#include <string>
#include <vector>

#include "bench/report.h"
#include "gpu/device.h"

namespace sf::bench {

struct CurvePoint {
  double count = 0.0;   ///< number of robots or segments
  double wall_s = 0.0;  ///< [s] median wall time of a tick
  double cpu_s = 0.0;   ///< [s] CPU time on all cores
  double load_s = 0.0;  ///< [s] wall time from the loaded world to the first reading
  double memory = 0.0;  ///< [byte] resident memory of world, fleet and farm
};

struct Curve {
  std::string what;
  std::string unit;  ///< of `count`
  std::vector<CurvePoint> points;
  double exponent = 0.0;  ///< of CPU time over count, by a least-squares fit of logarithms, for counts of at least 100
};

/// 10 to `most` robots in caves of 16 m with 100 robots each; 361 beams to 8 m; all sensors due in every tick.
Curve robots_curve(gpu::Device& device, bool wander, std::uint32_t most);

/// 100 to `most` segments: blocks of 6 m, streets of 4 m, 100 robots wandering in the middle, 361 beams to 8 m.
Curve segments_curve(gpu::Device& device, std::size_t most);

Report curve_report(const Curve& curve);
/// Draws cost.png; does nothing without curves. Both axes are logarithmic, so that a line's slope is its exponent.
void draw_curves(const std::vector<Curve>& curves, const std::string& folder);

}  // namespace sf::bench
