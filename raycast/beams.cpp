#include "raycast/beams.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"

namespace sf::raycast {

BeamPlan plan_beams(const ScanSettings& scan, bool with_noise) {
  constexpr double kMaxSpread = 0.5 * (2.0 * M_PI / SF_SECTORS);
  BeamPlan plan;
  for (std::uint32_t i = 0; i < scan.samples; i += scan.resolution) plan.samples.push_back(i);
  if (plan.samples.back() != scan.samples - 1) plan.samples.push_back(scan.samples - 1);

  const double step = scan.samples > 1 ? scan.fov / (scan.samples - 1) : 0.0;
  const double jitter = with_noise ? kMaxSigmas * scan.noise.angle_sigma : 0.0;
  const double spread = 0.5 * (SF_BEAMS_PER_LANE - 1) * scan.resolution * step + jitter;
  plan.packed = spread <= kMaxSpread;
  plan.spread = plan.packed ? spread : 0.0;
  return plan;
}

void draw_angle_noise(const ScanSettings& scan, const BeamPlan& plan, const base::RandomKey& draw,
                      std::span<double> angle_noise) {
  for (std::size_t k = 0; k < angle_noise.size(); ++k) {
    const double normal = base::random_normal(draw, plan.samples[k])[0];
    angle_noise[k] = scan.noise.angle_sigma * std::clamp(normal, -kMaxSigmas, kMaxSigmas);
  }
}

void write_beams(const ScanSettings& scan, const BeamPlan& plan, const std::vector<double>& angle_noise,
                 const BeamTables& tables) {
  const std::size_t count = plan.samples.size();
  for (std::size_t lane = 0; lane < plan.lanes(); ++lane) {
    double low = 0.0;
    double high = 0.0;
    for (std::size_t i = 0; i < SF_BEAMS_PER_LANE; ++i) {
      // Unused places repeat the last beam.
      const std::size_t k = plan.packed ? std::min(SF_BEAMS_PER_LANE * lane + i, count - 1) : lane;
      const double bearing = bearing_of(scan, plan.samples[k]) + (angle_noise.empty() ? 0.0 : angle_noise[k]);
      low = i == 0 ? bearing : std::min(low, bearing);
      high = i == 0 ? bearing : std::max(high, bearing);
      const auto [s, c] = base::sin_cos(bearing);
      tables.directions64[8 * lane + 2 * i] = c;
      tables.directions64[8 * lane + 2 * i + 1] = s;
    }
    tables.mid_bearings[lane] = static_cast<float>(0.5 * (low + high) * (SF_SECTORS / (2.0 * M_PI)));
  }
}

}  // namespace sf::raycast
