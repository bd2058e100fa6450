#pragma once
// Readings from the cast beams of a laser: range noise, and interpolation of the samples that `resolution` leaves out.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "base/echo.h"
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

/// Settings with which beams are cast for `finish_scan`: a surface nearer than range_min reads the largest number below
/// it.
inline raycast::ScanSettings cast_settings(raycast::ScanSettings scan) {
  scan.range_min = scan.range_min > 0.0 ? std::nextafter(scan.range_min, 0.0) : 0.0;
  return scan;
}

/// Samples of one scan, one per sample each.
struct FinishedScan {
  std::span<double> ranges;       ///< [m]
  std::span<std::uint32_t> hits;  ///< model of the hit, or base::kNoHit
  std::span<base::QualityFlag> quality;
};

/// Range noise is added to hits only, and clamped to [range_min, range_max]; a range that reaches range_max is no hit.
/// An interpolated sample has a model where both neighbours hit the same one. Its range lies on the straight line
/// between the neighbours' ranges, as in Stage; or, with `shape.sines`, on the straight line between the neighbours'
/// points, which is exact on a flat wall, and equals the nearer neighbour's range where they hit different models.
/// @param draw key of `base::RandomStream::range_noise`  @param noise false: no noise, whatever the laser's settings
/// @param cast of `cast_settings`
/// @param scan out: `quality` is set to `too_near` where the surface, or that of the nearer cast beam, is nearer than
/// range_min, whatever noise was added, and kept elsewhere
/// @return true when any sample is too near
bool finish_scan(const CastLaser& shape, const raycast::BeamPlan& plan, const base::RandomKey& draw, bool noise,
                 const CastScan& cast, const FinishedScan& scan);

/// Copies a reading's values; in a scan, infinity replaces the range of a beam without an echo. Other types, which have
/// no hits, have no beams either: sonar and infrared keep `range_max`.
/// @param values out: as many as the reading has
inline void mark_no_return(const base::ReadingBlock& reading, double range_max, std::span<double> values) {
  const bool scan = !reading.hits.empty();
  const auto marked = [&](double value) {
    return scan && base::echo_of(value, {.max = range_max}) == base::Echo::none ? HUGE_VAL : value;
  };
  std::transform(reading.values.begin(), reading.values.end(), values.begin(), marked);
}

}  // namespace sf::sensors
