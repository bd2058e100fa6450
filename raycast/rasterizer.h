#pragma once
// A scan by scan conversion: each segment is projected once to the beams that it covers, and each beam keeps the
// nearest.
//
// Needs: blocks with every segment that a beam could meet. Result: equal, bit by bit, to `intersect` over all of them.
//
// In the sensor's frame a segment a + u e, seen from its right, has along bearing b the inverse range
//   1 / t = (ex sin b - ey cos b) / (e x a): two products a beam, no division.
// Each beam keeps the largest lower bound of 1 / t among segments that certainly cover it, with the upper bound of that
// segment, and the largest upper bound among all others. Where the first exceeds the last, the nearest segment is
// certified and its range is evaluated in 64 bits as `intersect` does. Otherwise the beam is uncertain and is
// intersected with every segment in 64 bits.
//
// Errors, with coordinates up to A, u = 2^-24, band = 16 u A: the error of (e x a) is below 0.63 band |e|. The error of
// 1 / t is then below h (2 band h + 17 u), h = |e| / (e x a), where e x a exceeds band |e|. Other segments are edge-on
// and certify nothing. The error of bearings is below 2 band / |a| plus 1.3e-6 rad of rounding.
//
// A certified beam does not graze: its lower bound exceeds 0, so h^2 < 1 / (2 band t), and its sine, 1 / (h t), exceeds
// sqrt(2 band / t) >= sqrt(2 SF_COORDINATE_ERROR) = 1.4e-3.

#include <memory>

#include "raycast/scan_tables.h"

namespace sf::raycast {

/// Up to this number of beams, a scan intersects each beam in 64 bits instead of projecting all segments.
inline constexpr std::uint32_t kMaxExactBeams = 3;

/// With more uncertain beams than this, a scan projects all segments again and intersects each with the beams that it
/// may be nearest to. With fewer, each beam is intersected with the segments that it crosses.
inline constexpr std::size_t kMaxSingleDecisions = 24;

/// Scans of one thread, with their scratch memory. Not thread-safe.
class Rasterizer {
 public:
  Rasterizer();
  ~Rasterizer();
  Rasterizer(Rasterizer&&) noexcept;

  /// @return true when any beam grazes; only then `out.grazes` is filled in
  bool scan(const ScanView& view, const ScanPattern& pattern, const ScanScene& scene, const ScanOutput& out);
  const ScanCounts& counts() const;

  struct Scratch;

 private:
  std::unique_ptr<Scratch> scratch_;
};

/// The instruction set of this machine's scans in Highway's naming, such as "AVX2".
const char* vector_instructions();

}  // namespace sf::raycast
