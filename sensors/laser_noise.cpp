#include "sensors/laser_noise.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"

namespace sf::sensors {

namespace {

/// A cast beam.
struct Cast {
  std::uint32_t sample;
  double range;  ///< [m]
  std::uint32_t hit;
  bool too_near;
};

/// Returns the model of a sample. Noise may move a hit out of range.
std::uint32_t model_at(const CastLaser& shape, double range, std::uint32_t hit) {
  return range < shape.laser.range_max ? hit : base::kNoHit;
}

Cast cast_beam(const CastLaser& shape, const base::RandomKey& draw, bool noisy, std::uint32_t sample, double range,
               std::uint32_t hit) {
  const LaserSettings& laser = shape.laser;
  Cast beam{sample, std::max(range, laser.range_min), hit, range < laser.range_min};
  if (!noisy || hit == base::kNoHit) return beam;
  const double sigma = base::hypot(laser.noise.range_sigma, laser.noise.range_proportional * beam.range);
  const double disturbed = beam.range + sigma * base::random_normal(draw, sample)[0];
  beam.range = std::clamp(disturbed, laser.range_min, laser.range_max);
  return beam;
}

/// Interpolates the samples between two cast beams. @return true when any is too near
bool fill_chords(const CastLaser& shape, const Cast& a, const Cast& b, const FinishedScan& scan) {
  const LaserSettings& laser = shape.laser;
  const std::vector<double>& sines = shape.sines;
  const std::uint32_t gap = b.sample - a.sample;
  const bool same = a.hit == b.hit;
  const double above = a.range * b.range * sines[gap];
  bool any = false;
  for (std::uint32_t j = 1; j < gap; ++j) {
    const double across = a.range * sines[j] + b.range * sines[gap - j];
    const double chord = above > 0.0 && across > 0.0 ? above / across : std::min(a.range, b.range);
    const double nearer = 2 * j < gap ? a.range : b.range;
    scan.ranges[a.sample + j] = same ? std::clamp(chord, laser.range_min, laser.range_max) : nearer;
    if (!same || chord >= laser.range_min) continue;
    scan.quality[a.sample + j] = base::QualityFlag::too_near;
    any = true;
  }
  return any;
}

void fill_lines(const Cast& a, const Cast& b, const FinishedScan& scan) {
  for (std::uint32_t j = a.sample + 1; j < b.sample; ++j) {
    const double part = static_cast<double>(j - a.sample) / (b.sample - a.sample);
    scan.ranges[j] = a.range + part * (b.range - a.range);
  }
}

bool fill_between(const CastLaser& shape, const Cast& a, const Cast& b, const FinishedScan& scan) {
  const bool chords = !shape.sines.empty() && (a.hit != base::kNoHit || b.hit != base::kNoHit);
  const bool any = chords && fill_chords(shape, a, b, scan);
  if (!chords) fill_lines(a, b, scan);
  for (std::uint32_t j = a.sample + 1; j < b.sample; ++j) {
    scan.hits[j] = a.hit == b.hit ? model_at(shape, scan.ranges[j], a.hit) : base::kNoHit;
    const Cast& nearer = 2 * (j - a.sample) < b.sample - a.sample ? a : b;
    if (nearer.too_near) scan.quality[j] = base::QualityFlag::too_near;
  }
  return any;
}

}  // namespace

bool finish_scan(const CastLaser& shape, const raycast::BeamPlan& plan, const base::RandomKey& draw, bool noise,
                 const CastScan& cast, const FinishedScan& scan) {
  const bool noisy = noise && shape.laser.noise.has_range();
  bool any = false;
  Cast before{};
  for (std::size_t k = 0; k < plan.samples.size(); ++k) {
    const std::size_t place = plan.place(k);
    const Cast now = cast_beam(shape, draw, noisy, plan.samples[k], cast.ranges[place], cast.hits[place]);
    scan.ranges[now.sample] = now.range;
    scan.hits[now.sample] = model_at(shape, now.range, now.hit);
    if (now.too_near) scan.quality[now.sample] = base::QualityFlag::too_near;
    any = any || now.too_near;
    if (now.sample > before.sample + 1 && fill_between(shape, before, now, scan)) any = true;
    before = now;
  }
  return any;
}

}  // namespace sf::sensors
