#include "sensors/laser_noise.h"

#include <algorithm>
#include <cmath>

namespace sf::sensors {

namespace {

/// A cast beam.
struct Cast {
  std::uint32_t sample;
  double range;  ///< [m]
  std::uint32_t hit;
};

/// Interpolates the samples between two cast beams.
void fill_chords(const CastLaser& shape, const Cast& a, const Cast& b, std::span<double> ranges) {
  const LaserSettings& laser = shape.laser;
  const std::vector<double>& sines = shape.sines;
  const std::uint32_t gap = b.sample - a.sample;
  const bool same = a.hit == b.hit;
  const double above = a.range * b.range * sines[gap];
  for (std::uint32_t j = 1; j < gap; ++j) {
    const double across = a.range * sines[j] + b.range * sines[gap - j];
    const double chord = above > 0.0 && across > 0.0 ? above / across : std::min(a.range, b.range);
    const double nearer = 2 * j < gap ? a.range : b.range;
    ranges[a.sample + j] = same ? std::clamp(chord, laser.range_min, laser.range_max) : nearer;
  }
}

void fill_lines(const Cast& a, const Cast& b, std::span<double> ranges) {
  for (std::uint32_t j = a.sample + 1; j < b.sample; ++j) {
    const double part = static_cast<double>(j - a.sample) / (b.sample - a.sample);
    ranges[j] = a.range + part * (b.range - a.range);
  }
}

}  // namespace

void finish_scan(const CastLaser& shape, const raycast::BeamPlan& plan, const base::RandomKey& draw, bool noise,
                 const CastScan& cast, std::span<double> ranges, std::span<std::uint32_t> hits) {
  const LaserSettings& laser = shape.laser;
  const bool noisy = noise && laser.noise.has_range();
  Cast before{};
  for (std::size_t k = 0; k < plan.samples.size(); ++k) {
    Cast now{plan.samples[k], cast.ranges[plan.place(k)], cast.hits[plan.place(k)]};
    if (noisy && now.hit != base::kNoHit) {
      const double sigma = std::hypot(laser.noise.range_sigma, laser.noise.range_proportional * now.range);
      now.range =
          std::clamp(now.range + sigma * base::random_normal(draw, now.sample)[0], laser.range_min, laser.range_max);
    }
    ranges[now.sample] = now.range;
    hits[now.sample] = now.hit;
    if (now.sample > before.sample + 1) {
      if (!shape.sines.empty() && (before.hit != base::kNoHit || now.hit != base::kNoHit))
        fill_chords(shape, before, now, ranges);
      else
        fill_lines(before, now, ranges);
      const std::uint32_t between = before.hit == now.hit ? now.hit : base::kNoHit;
      std::fill(hits.begin() + before.sample + 1, hits.begin() + now.sample, between);
    }
    before = now;
  }
}

}  // namespace sf::sensors
