#pragma once
// Scan conversion: projects each segment once to the beams that it covers. Each beam keeps the nearest segment.
//
// Input: blocks with every segment that a beam could meet. Output: bit-identical to `intersect` over all of them.
//
// In the sensor's frame a segment a + u e, seen from its right, has along bearing b the inverse range
//   1 / t = (ex sin b - ey cos b) / (e x a): two products per beam and no division.
// Each beam keeps the largest lower bound of 1 / t among segments that certainly cover it, with the upper bound of that
// segment, and the largest upper bound among all others. If the first exceeds the last, the nearest segment is
// certified, and its range is evaluated in 64 bits as in `intersect`. Otherwise the beam is uncertain and is
// intersected with every segment in 64 bits.
//
// Errors, with coordinates up to A, u = 2^-24, band = 16 u A: the error of (e x a) is below 0.63 band |e|. The error of
// 1 / t is then below h (2 band h + 17 u), h = |e| / (e x a), if e x a exceeds band |e|. Other segments are edge-on and
// never certified. The error of bearings is below 2 band / |a| plus 1.3e-6 rad of rounding.
//
// A certified beam does not graze: its lower bound exceeds 0, so h^2 < 1 / (2 band t), and its sine, 1 / (h t), exceeds
// sqrt(2 band / t) >= sqrt(2 SF_COORDINATE_ERROR) = 1.4e-3.

#include <memory>

#include "raycast/scan_tables.h"

namespace sf::raycast {

/// Scans of at most this many beams intersect each beam in 64 bits instead of projecting all segments.
inline constexpr std::uint32_t kMaxExactBeams = 3;

/// A scan with more uncertain beams than this projects all segments again and intersects each one with the beams for
/// which it may be the nearest. With fewer, it intersects each beam with the segments that it crosses.
inline constexpr std::size_t kMaxSingleDecisions = 24;

/// Computes scans in its own scratch memory: one object per thread. Not thread-safe.
class Rasterizer {
 public:
  Rasterizer();
  ~Rasterizer();
  Rasterizer(Rasterizer&&) noexcept;

  /// @return true if any beam grazes a surface; `out.grazes` is filled in only then
  bool scan(const ScanView& view, const ScanPattern& pattern, const ScanScene& scene, const ScanOutput& out);
  const ScanCounts& counts() const;

  struct Scratch;

 private:
  std::unique_ptr<Scratch> scratch_;
};

/// Returns the instruction set that scans use on this machine, by Highway's name, such as "AVX2".
const char* vector_instructions();

}  // namespace sf::raycast
