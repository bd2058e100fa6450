#pragma once
// Memory that one thread's scans keep between uses.

#include <cstdint>
#include <vector>

#include "raycast/rasterizer.h"

namespace sf::raycast {

/// A mover that may be seen, with the beams that its disc touches, at places past either end too.
struct NearMover {
  float distance;  ///< [m] of its nearest point, at least
  std::uint32_t mover;
  float low, high;  ///< places
};

struct Rasterizer::Scratch {
  // Segments as projected, in vectors of which not all places need be in use.
  std::vector<float> a, b, error;  ///< 1 / t = a cos + b sin, within error [1/m]
  std::vector<float> low_possible, high_possible, low_certain,
      high_certain;                       ///< places of beams that it may cover and surely covers
  std::vector<std::int32_t> first, last;  ///< beams to look at
  std::vector<std::uint32_t> row;         ///< exact segment
  std::vector<std::uint32_t> live;        ///< indices in use
  std::uint32_t used = 0;

  // Beams.
  std::vector<float> near_low, near_high, others;  ///< [1/m] of the nearest so far, and the most of all others
  std::vector<std::int32_t> nearest_segment;       ///< segment, or -1
  std::vector<std::uint64_t> ends, uncertain;      ///< a bit a beam

  // Movers.
  std::vector<NearMover> near;
  std::vector<std::uint64_t> order;   ///< of `near` by distance
  std::vector<std::uint32_t> across;  ///< movers whose discs one beam crosses

  ScanCounts counts;

  void begin(std::uint32_t beams);
  /// Room for `more` segments behind those in use.
  void reserve(std::uint32_t more);
};

}  // namespace sf::raycast
