#pragma once
// How far beams from a sensor above a height field certainly do not meet it, by azimuth and elevation: starts for
// searches. One per scan (rasterizer/horizon-inl.h).
//
// Horizontal distances are |x| + |y|, in which slopes and sectors of a block follow from its corners alone: over a
// plane, height / distance is largest at a corner where it is negative.

#include <cstdint>

namespace sf::scene {

/// A beam of azimuth in sector s that rises by more than slope[s][k] [m per metre of distance] does not meet the field
/// within ring k, which ends at the distance min(last, inner (1 + k % 4 / 4) 2^(k / 4)). Slopes grow with k.
struct Horizon {
  static constexpr std::int32_t kSectors = 128;   ///< a power of 2
  static constexpr std::int32_t kMostRings = 64;  ///< a multiple of 16
  std::int32_t rings = 0;
  float inner = 0.0f;  ///< [m]
  float last = 0.0f;   ///< [m] the whole field, or the range
  alignas(64) float slope[kSectors][kMostRings];
  float highest;  ///< largest of the slopes; beams that rise by more meet nothing
};

}  // namespace sf::scene
