#pragma once
// The beams of a laser: selection, directions and packing into lanes.

#include <cstdint>
#include <span>
#include <vector>

#include "base/random.h"
#include "raycast/records.h"
#include "world/world.h"

namespace sf::raycast {

/// The cast beams of one laser, in lanes of SF_BEAMS_PER_LANE.
struct BeamPlan {
  std::vector<std::uint32_t> samples;  ///< numbers of the samples that are cast, ascending
  bool packed = true;                  ///< adjacent beams share a lane; false: one beam per lane, in its first place
  double spread = 0.0;                 ///< [rad] largest angle from a lane's middle bearing to its outermost beam

  std::uint32_t lanes() const {
    const auto count = static_cast<std::uint32_t>(samples.size());
    return packed ? (count + SF_BEAMS_PER_LANE - 1) / SF_BEAMS_PER_LANE : count;
  }
  /// Index of the k-th cast beam among the sensor's results.
  std::size_t place(std::size_t k) const { return packed ? k : SF_BEAMS_PER_LANE * k; }
};

BeamPlan plan_beams(const world::Laser& laser, bool with_noise);

/// Draws the angular noise of each cast beam.
/// @param draw key of `base::RandomStream::angle_noise`
/// @param angle_noise [rad] out: one value per cast beam
void draw_angle_noise(const world::Laser& laser, const BeamPlan& plan, const base::RandomKey& draw,
                      std::span<double> angle_noise);

/// The part of the device's beam tables that belongs to one laser. Pointers to its first lane.
struct BeamTables {
  float* mid_bearings;   ///< [sectors] one per lane
  double* directions64;  ///< 8 per lane: cosine and sine of each beam
};

/// Writes the tables of `plan`. Beam k is turned by `angle_noise[k]` [rad]; an empty vector means no noise.
void write_beams(const world::Laser& laser, const BeamPlan& plan, const std::vector<double>& angle_noise,
                 const BeamTables& tables);

/// Truncation of angular noise, in standard deviations. A bounded angle keeps the lists of walls complete.
inline constexpr double kMaxSigmas = 6.0;

}  // namespace sf::raycast
