#pragma once
// A laser's beams: which are cast, where they point, and how they are packed into lanes.

#include <cstdint>
#include <span>
#include <vector>

#include "base/random.h"
#include "raycast/records.h"
#include "world/world.h"

namespace sf::raycast {

/// How one laser's beams lie in lanes of four.
struct BeamPlan {
  std::vector<std::uint32_t> samples;  ///< sample numbers that are cast, in order
  bool packed = true;                  ///< four adjacent beams a lane; false: one, in the lane's first place
  double spread = 0.0;                 ///< [rad] from a lane's middle bearing to its outermost beam, at most

  std::uint32_t lanes() const {
    const auto count = static_cast<std::uint32_t>(samples.size());
    return packed ? (count + SF_BEAMS_PER_LANE - 1) / SF_BEAMS_PER_LANE : count;
  }
  /// Place of the k-th cast beam among its sensor's results.
  std::size_t place(std::size_t k) const { return packed ? k : SF_BEAMS_PER_LANE * k; }
};

BeamPlan plan_beams(const world::Laser& laser, bool with_noise);

/// Angular noise: how far each cast beam is turned. @param draw of `base::RandomStream::angle_noise` @param turns [rad]
/// one per cast beam
void draw_angle_noise(const world::Laser& laser, const BeamPlan& plan, const base::RandomKey& draw,
                      std::span<double> angle_noise);

/// Rows of the device's beam tables for one laser, from its first lane on.
struct BeamTables {
  float* mid_bearings;   ///< [sectors] one per lane
  double* directions64;  ///< 8 per lane: cosine, sine of each beam
};

/// Writes the tables of `plan`, each cast beam k turned by `angle_noise[k]` [rad] (empty: none).
void write_beams(const world::Laser& laser, const BeamPlan& plan, const std::vector<double>& angle_noise,
                 const BeamTables& tables);

/// Largest turn angular noise may give, in standard deviations: beyond, it is cut off, so that lists can be trusted.
inline constexpr double kMaxSigmas = 6.0;

}  // namespace sf::raycast
