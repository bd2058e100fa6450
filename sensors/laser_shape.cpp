#include "sensors/laser_shape.h"

#include <algorithm>
#include <cmath>

namespace sf::sensors {

namespace {

/// A beam that was cast.
struct Cast {
  std::uint32_t sample;
  double range;  ///< [m]
  std::uint32_t hit;
};

/// [m] of sample `j` between two beams that met the same, by the straight line between their ends.
double on_chord(const world::Laser& laser, const Cast& a, const Cast& b, std::uint32_t j) {
  const double step = laser.fov / (laser.samples - 1);
  const double whole = std::sin((b.sample - a.sample) * step);
  const double from_a = std::sin((j - a.sample) * step), to_b = std::sin((b.sample - j) * step);
  const double across = a.range * from_a + b.range * to_b;
  return whole > 0.0 && across > 0.0 ? a.range * b.range * whole / across : std::min(a.range, b.range);
}

double between(const CastLaser& shape, const Cast& a, const Cast& b, std::uint32_t j) {
  const double part = static_cast<double>(j - a.sample) / (b.sample - a.sample);
  if (!shape.chords || (a.hit == b.hit && a.hit == base::kNoHit)) return a.range + part * (b.range - a.range);
  if (a.hit != b.hit) return part < 0.5 ? a.range : b.range;
  return std::clamp(on_chord(shape.laser, a, b, j), shape.laser.range_min, shape.laser.range_max);
}

}  // namespace

void shape_scan(const CastLaser& shape, const BeamPlan& plan, const base::Draw& draw, bool noise, const CastScan& cast,
                std::span<double> ranges, std::span<std::uint32_t> hits) {
  const world::Laser& laser = shape.laser;
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
    for (std::uint32_t j = before.sample + 1; j < now.sample; ++j) {
      ranges[j] = between(shape, before, now, j);
      hits[j] = before.hit == now.hit ? now.hit : base::kNoHit;
    }
    before = now;
  }
}

}  // namespace sf::sensors
