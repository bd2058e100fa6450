#pragma once
// Readings from the cast beams of a laser: range noise, and interpolation of the samples that `resolution` leaves out.

#include <cstdint>
#include <limits>
#include <span>

#include "base/random.h"
#include "base/reading.h"
#include "raycast/beams.h"
#include "sensors/laser_modes.h"

namespace sf::sensors {

/// Results of one scan's cast beams, beam k at `plan.place(k)`.
struct CastScan {
  const double* ranges;       ///< [m]
  const std::uint32_t* hits;  ///< model of the hit, or base::kNoHit
};

/// Range noise is added to hits only, and clamped to [range_min, range_max]. An interpolated sample has a model where
/// both neighbours hit the same one. Its range lies on the straight line between the neighbours' ranges, as in Stage;
/// or, with `shape.sines`, on the straight line between the neighbours' points, which is exact on a flat wall, and
/// equals the nearer neighbour's range where they hit different models.
/// @param draw key of `base::RandomStream::range_noise`  @param noise false: no noise, whatever the laser's settings
/// @param ranges, hits one per sample
void finish_scan(const CastLaser& shape, const raycast::BeamPlan& plan, const base::RandomKey& draw, bool noise,
                 const CastScan& cast, std::span<double> ranges, std::span<std::uint32_t> hits);

/// Range with infinity for no return. @param range [m] of a beam that met `hit`
inline double or_infinite(double range, std::uint32_t hit, double range_max) {
  return hit == base::kNoHit && range >= range_max ? std::numeric_limits<double>::infinity() : range;
}

/// Applies `or_infinite` to a scan. @param ranges out: one per sample
inline void mark_no_return(const base::ReadingBlock& scan, double range_max, std::span<double> ranges) {
  for (std::size_t i = 0; i < scan.hits.size(); ++i) ranges[i] = or_infinite(scan.values[i], scan.hits[i], range_max);
}

}  // namespace sf::sensors
