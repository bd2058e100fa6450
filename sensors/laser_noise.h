#pragma once
// From what a laser's beams measured to its reading: noise, and the samples that `resolution` left out.

#include <cstdint>
#include <limits>
#include <span>

#include "base/random.h"
#include "base/reading.h"
#include "raycast/beams.h"
#include "sensors/laser_modes.h"
#include "world/world.h"

namespace sf::sensors {

/// What the cast beams of one scan measured, beam k at `plan.place(k)`.
struct CastScan {
  const double* ranges;       ///< [m]
  const std::uint32_t* hits;  ///< model row of what was met, or base::kNoHit
};

/// Range noise is added to echoes alone, and kept within [range_min, range_max]. A sample that was not cast names a
/// model where both of its neighbours met the same. Its range lies on a straight line between theirs, as Stage has it;
/// or, where it has sines, on the straight line between the points that these met, which is right on a flat wall, and
/// is the nearer neighbour's where they met different models.
/// @param draw of `base::RandomStream::range_noise` @param noise false: none, whatever the laser has
/// @param ranges, hits one per sample
void finish_scan(const CastLaser& shape, const raycast::BeamPlan& plan, const base::RandomKey& draw, bool noise,
                 const CastScan& cast, std::span<double> ranges, std::span<std::uint32_t> hits);

/// A range as users who want infinity for "nothing met" are told it. @param range [m] of a beam that met `hit`
inline double or_infinite(double range, std::uint32_t hit, double range_max) {
  return hit == base::kNoHit && range >= range_max ? std::numeric_limits<double>::infinity() : range;
}

/// All of a scan so, into `ranges`, one per sample.
inline void mark_no_return(const base::ReadingBlock& scan, double range_max, std::span<double> ranges) {
  for (std::size_t i = 0; i < scan.hits.size(); ++i) ranges[i] = or_infinite(scan.values[i], scan.hits[i], range_max);
}

}  // namespace sf::sensors
