#pragma once
// One scan by conversion: each segment is projected once to the beams that it covers, the nearest stays.
//
// Needs: blocks that hold every segment that could be met. Gives: the answers of `decide` over all of them, bit by bit.
//
// In the sensor's frame a segment a + u e, seen from its right, has along bearing b the inverse range
//   1 / t = (ex sin b - ey cos b) / (e x a): two products a beam, no division.
// Each beam keeps the largest lower bound of 1 / t among segments that surely cover it, with that one's upper bound,
// and the largest upper bound among all others. Where the first exceeds the last, the nearest segment is proven, and
// its range is evaluated in 64 bits as `decide` does; else the beam meets every segment in 64 bits.
//
// Errors, with coordinates up to A, u = 2^-24, band = 16 u A: (e x a) is wrong by less than 0.63 band |e|, so that of 1
// / t is less than h (2 band h + 17 u), h = |e| / (e x a), where e x a exceeds band |e|: others are edge-on and prove
// nothing. Bearings are wrong by less than 2 band / |a| and 1.3e-6 rad of rounding.
//
// A proven beam does not graze: its lower bound exceeds 0, so h^2 < 1 / (2 band t), and its sine, 1 / (h t), is above
// sqrt(2 band / t) >= sqrt(2 SF_BAND) = 1.4e-3.

#include <memory>

#include "raycast/scan_tables.h"

namespace sf::raycast {

/// So few beams are not worth drawing everything around: each is decided alone.
inline constexpr std::uint32_t kMaxExactBeams = 3;

/// Scratch of one thread.
class Rasterizer {
 public:
  Rasterizer();
  ~Rasterizer();
  Rasterizer(Rasterizer&&) noexcept;

  /// @return whether any beam grazes: `out.grazes` is filled in only then
  bool scan(const ScanView& view, const ScanPattern& pattern, const ScanScene& scene, const ScanOutput& out);
  const ScanCounts& counts() const;

  struct Scratch;

 private:
  std::unique_ptr<Scratch> scratch_;
};

/// Which instructions this machine's scans use, as Highway names them, e.g. "AVX2".
const char* vector_instructions();

}  // namespace sf::raycast
