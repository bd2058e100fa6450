#pragma once
// Scratch memory of one thread's scans, kept between scans.

#include <cstdint>
#include <vector>

#include "raycast/rasterizer.h"

namespace sf::raycast {

/// A mover that may be visible, with the interval of beams that its disc covers. The interval may exceed the view.
struct NearMover {
  float distance;  ///< [m] lower bound of the distance to its nearest point
  std::uint32_t mover;
  float low, high;  ///< [places] as `ScanPattern::place`
};

struct Rasterizer::Scratch {
  // Projected segments, in whole vectors: only the indices in `live` are in use.
  std::vector<float> a, b, error;  ///< 1 / t = a cos + b sin, within error [1/m]
  std::vector<float> low_possible, high_possible, low_certain,
      high_certain;                       ///< places of beams that the segment may cover, and certainly covers
  std::vector<std::int32_t> first, last;  ///< interval of beams to test
  std::vector<std::uint32_t> row;         ///< row of the exact segment
  std::vector<std::uint32_t> live;        ///< indices in use
  std::uint32_t used = 0;

  // Beams.
  std::vector<float> near_low, near_high, others;  ///< [1/m] bounds of the nearest so far; largest bound of all others
  std::vector<std::int32_t> nearest_segment;       ///< index of the segment, or -1
  std::vector<std::uint64_t> ends, uncertain;      ///< one bit per beam

  // Movers.
  std::vector<NearMover> near;
  std::vector<std::uint64_t> order;   ///< of `near`, by distance
  std::vector<std::uint32_t> across;  ///< movers whose discs one beam crosses

  ScanCounts counts;

  void begin(std::uint32_t beams);
  /// Makes room for `more` segments behind those in use.
  void reserve(std::uint32_t more);
};

}  // namespace sf::raycast
