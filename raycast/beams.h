#pragma once
// Beams of a planar scan: settings, selection, directions and packing into lanes.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/bearing.h"
#include "base/pose.h"
#include "base/random.h"
#include "raycast/records.h"

namespace sf::raycast {

/// Noise of a scan. All zeros disable noise. Range noise applies only to beams with an echo.
struct ScanNoise {
  double range_sigma = 0.0;         ///< [m] constant part of the range's standard deviation
  double range_proportional = 0.0;  ///< [-] part of the standard deviation per metre of range
  double angle_sigma = 0.0;         ///< [rad] standard deviation of each beam's bearing, applied before the cast

  bool has_range() const { return range_sigma > 0.0 || range_proportional > 0.0; }
};

/// Settings of a planar scan. Bearings run from -fov/2 to +fov/2, and beams at both ends are cast exactly. A single
/// sample has bearing 0.
struct ScanSettings {
  std::string name;              ///< sensor name, for messages
  base::Pose X_MS;               ///< sensor in the mover's frame; z is the height above the mover's origin
  double fov = M_PI;             ///< [rad] in [0, 2 pi]
  std::uint32_t samples = 180;   ///< in [1, 1'000'000]
  double range_min = 0.0;        ///< [m] nearer echoes read range_min
  double range_max = 8.0;        ///< [m] > 0; a beam without a nearer echo reads range_max
  std::uint32_t resolution = 1;  ///< casts only every n-th beam and the last one
  ScanNoise noise;               ///< ray casting applies only its angular part
};

/// Same as base::bearing_of.
inline double bearing_of(const ScanSettings& scan, std::uint32_t i) {
  return base::bearing_of(scan.fov, scan.samples, i);
}

/// The cast beams of one scan, in lanes of SF_BEAMS_PER_LANE.
struct BeamPlan {
  std::vector<std::uint32_t> samples;  ///< indices of the cast samples, ascending
  bool packed = true;   ///< adjacent beams share a lane; false: each lane has one beam, in its first place
  double spread = 0.0;  ///< [rad] largest angle from a lane's middle bearing to its outermost beam

  std::uint32_t lanes() const {
    const auto count = static_cast<std::uint32_t>(samples.size());
    return packed ? (count + SF_BEAMS_PER_LANE - 1) / SF_BEAMS_PER_LANE : count;
  }
  /// Returns the index of the k-th cast beam in the sensor's results.
  std::size_t place(std::size_t k) const { return packed ? k : SF_BEAMS_PER_LANE * k; }
};

BeamPlan plan_beams(const ScanSettings& scan, bool with_noise);

/// Draws the angular noise of each cast beam.
/// @param draw key of `base::RandomStream::angle_noise`
/// @param angle_noise [rad] out: one value per cast beam
void draw_angle_noise(const ScanSettings& scan, const BeamPlan& plan, const base::RandomKey& draw,
                      std::span<double> angle_noise);

/// One scan's part of the device's beam tables. The pointers address its first lane.
struct BeamTables {
  float* mid_bearings;   ///< [sectors] one per lane
  double* directions64;  ///< 8 per lane: cosine and sine of each beam's bearing
};

/// Writes the tables of `plan`. Rotates beam k by `angle_noise[k]` [rad]; an empty vector means no noise.
void write_beams(const ScanSettings& scan, const BeamPlan& plan, const std::vector<double>& angle_noise,
                 const BeamTables& tables);

/// Angular noise is truncated at this many standard deviations: wall lists are complete only for bounded angles.
inline constexpr double kMaxSigmas = 6.0;

}  // namespace sf::raycast
