#include "sensors/laser_shape.h"

#include <algorithm>
#include <cmath>

namespace sf::sensors {

void shape_scan(const world::Laser& laser, const BeamPlan& plan, const base::Draw& draw, bool noise,
                const CastScan& cast, std::span<double> ranges, std::span<std::uint32_t> hits) {
  const bool noisy = noise && laser.noise.has_range();
  std::uint32_t before = 0;
  for (std::size_t k = 0; k < plan.samples.size(); ++k) {
    const std::uint32_t sample = plan.samples[k];
    double range = cast.ranges[plan.place(k)];
    const std::uint32_t hit = cast.hits[plan.place(k)];
    if (noisy && hit != base::kNoHit) {
      const double sigma = std::hypot(laser.noise.range_sigma, laser.noise.range_proportional * range);
      range = std::clamp(range + sigma * base::random_normal(draw, sample)[0], laser.range_min, laser.range_max);
    }
    ranges[sample] = range;
    hits[sample] = hit;
    for (std::uint32_t j = before + 1; j < sample; ++j) {
      const double part = static_cast<double>(j - before) / (sample - before);
      ranges[j] = ranges[before] + part * (range - ranges[before]);
      hits[j] = hits[before] == hit ? hit : base::kNoHit;
    }
    before = sample;
  }
}

}  // namespace sf::sensors
