#pragma once
// Accuracy modes of lidars: ranges are measured in 32 bits; fewer columns are cast, the others interpolated between
// them; or meshes are simplified.

#include <cstdint>
#include <glm/ext/vector_double2.hpp>
#include <span>
#include <vector>

#include "base/reading.h"
#include "sensors/lidar_beams.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr AccuracyMode kLidarModes[] = {
    {"exact", "every beam"},
    {"single", "every beam, decided in 64 bits, measured in 32 bits where these are within 1 mm"},
    {"skip2", "every 2nd column; the others interpolated between the hits"},
    {"skip4", "every 4th column"},
    {"coarse1", "every beam; meshes simplified by at most 1 mrad as seen from the sensor"},
    {"coarse4", "meshes simplified by at most 4 mrad"},
};
// By row of kLidarModes.
inline constexpr bool kLidarSingle[] = {false, true, false, false, false, false};
inline constexpr std::uint32_t kLidarSkips[] = {1, 1, 2, 4, 1, 1};            ///< columns per cast column
inline constexpr double kLidarAngles[] = {0.0, 0.0, 0.0, 0.0, 0.001, 0.004};  ///< [rad] of displaced vertices

/// Returns two weights for each beam between cast columns: the inverse range between two points at `a` and `b` is the
/// sum of the weights times their inverse ranges, as it is linear in the direction. The beam is turned into the plane
/// of `a` and `b`.
/// @param beams with several columns and LidarBeams::cast
std::vector<glm::dvec2> interpolation_weights(const LidarBeams& beams);

/// A scan's tables, beam by beam.
struct LidarScan {
  std::span<double> values;  ///< `width` numbers per beam
  std::size_t width = 1;
  std::span<std::uint32_t> hits;
  std::span<base::QualityFlag> quality;
};

/// Fills in the beams that were not cast, with the flag `not_cast`. Between beams that hit one model, the range is that
/// of the straight line between their points, which is exact on a plane along a great circle; else all numbers are the
/// nearer beam's.
/// @param beams with several columns, of which `LidarBeams::cast` lists those with numbers, and `LidarBeams::between`
void interpolate_columns(const LidarBeams& beams, double range_max, const LidarScan& scan);

}  // namespace sf::sensors
