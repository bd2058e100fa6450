#pragma once
// Cost against size: ticks over robots at one density, and over segments of a city for the same hundred robots.

#include <string>
#include <vector>

#include "gpu/device.h"

namespace sf::bench {

struct CurvePoint {
  double count = 0.0;   ///< robots or segments
  double wall_s = 0.0;  ///< [s] median of a tick on the clock
  double cpu_s = 0.0;   ///< [s] on all cores
  double load_s = 0.0;  ///< [s] from the world in memory to the first reading, on the clock
  double memory = 0.0;  ///< [byte] resident for world, fleet and farm
};

struct Curve {
  std::string what;
  std::string unit;  ///< of `count`
  std::vector<CurvePoint> points;
  double exponent = 0.0;  ///< of cpu time over count, by least squares on logarithms, from 100 on
};

/// 10 to `most` robots in caves of 16 m, a hundred in each, 361 beams to 8 m, all looking in every tick.
Curve robots_curve(gpu::Device& device, bool wander, std::uint32_t most);

/// 100 to `most` segments: blocks of 6 m, streets of 4 m, 100 robots wandering in the middle, 361 beams to 8 m.
Curve segments_curve(gpu::Device& device, std::size_t most);

std::string curves_table(const std::vector<Curve>& curves);
/// Writes curves.csv; nothing where there are none.
void write_curves(const std::vector<Curve>& curves, const std::string& folder);
/// Draws cost.png; nothing where there are none. Both axes are logarithms, so that a line's slope is its exponent.
void draw_curves(const std::vector<Curve>& curves, const std::string& folder);

}  // namespace sf::bench
