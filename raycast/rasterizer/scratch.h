#pragma once
// Scratch memory of one thread's scans, kept between scans.

#include <cstdint>
#include <vector>

#include "raycast/rasterizer.h"

namespace sf::raycast {

/// A mover that may be visible, with the interval of beams that its disc covers. The interval may exceed the view.
struct NearMover {
  float distance;   ///< [m] lower bound of the distance to its nearest edge
  float low, high;  ///< interval [places], as ScanPattern::place
  std::uint32_t mover;
  bool outside;  ///< the viewer is outside of its disc
};

struct Rasterizer::Scratch {
  // Beams.
  std::vector<float> near_low, near_high, others;  ///< [1/m] bounds of the nearest so far; largest bound of all others
  std::vector<std::int32_t> nearest_row;           ///< exact segment, or -1
  std::vector<std::uint64_t> ends, uncertain;      ///< one bit per beam

  std::vector<double> x, y;       ///< directions, where many beams are uncertain
  std::vector<double> range;      ///< [m] nearest intersection so far, where many beams are uncertain
  std::vector<std::int64_t> row;  ///< its exact segment, or SF_NO_HIT

  // Movers.
  std::vector<NearMover> near;
  std::vector<std::uint64_t> order;   ///< of `near`, by distance
  std::vector<std::uint32_t> across;  ///< movers whose discs one beam crosses
  float horizon = 0.0f;               ///< [m] movers beyond it are hidden

  ScanCounts counts;

  void begin(std::uint32_t beams);
};

}  // namespace sf::raycast
