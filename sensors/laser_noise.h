#pragma once
// Computes readings from the cast beams of a laser: adds range noise, and interpolates the samples that `resolution`
// skips.

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

/// Returns the settings with which beams are cast for `finish_scan`: a surface nearer than range_min reads the largest
/// number below range_min.
inline raycast::ScanSettings cast_settings(raycast::ScanSettings scan) {
  scan.range_min = scan.range_min > 0.0 ? std::nextafter(scan.range_min, 0.0) : 0.0;
  return scan;
}

/// One scan, with one entry per sample in each span.
struct FinishedScan {
  std::span<double> ranges;       ///< [m]
  std::span<std::uint32_t> hits;  ///< model of the hit, or base::kNoHit
  std::span<base::QualityFlag> quality;
};

/// Adds range noise and interpolates. Noise is added to hits only, and clamped to [range_min, range_max]. A range that
/// reaches range_max is not a hit. An interpolated sample has a model if both neighbours hit the same model. Its range
/// is on the straight line between the neighbours' ranges, as in Stage. With `shape.sines`, it is on the straight line
/// between the neighbours' points, which is exact on a flat wall; if they hit different models, it equals the nearer
/// neighbour's range.
/// @param draw key of `base::RandomStream::range_noise`  @param noise false: adds no noise, whatever the laser's
/// settings
/// @param cast beams cast with `cast_settings`
/// @param scan out: `quality` is set to `too_near` if the surface, or that of the nearer cast beam, is nearer than
/// range_min, regardless of noise, and left unchanged otherwise
/// @return true when any sample is too near
bool finish_scan(const CastLaser& shape, const raycast::BeamPlan& plan, const base::RandomKey& draw, bool noise,
                 const CastScan& cast, const FinishedScan& scan);

/// Copies a reading's values. In a scan, infinity replaces the range of a beam without an echo. Other types have
/// neither hits nor beams: sonar and infrared keep `range_max`.
/// @param values out: as many as the reading has
inline void mark_no_return(const base::ReadingBlock& reading, double range_max, std::span<double> values) {
  const bool scan = !reading.hits.empty();
  std::ranges::copy(reading.values, values.begin());
  const std::size_t width = scan ? values.size() / reading.hits.size() : 0;
  for (std::size_t i = 0; scan && i < values.size(); i += width)
    if (base::echo_of(values[i], {.max = range_max}) == base::Echo::none) values[i] = HUGE_VAL;
}

}  // namespace sf::sensors
