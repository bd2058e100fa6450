#pragma once
// Readings: one block per sensor that was due, with the same layout for every sensor type.

#include <cstdint>
#include <limits>
#include <span>

#include "base/pose.h"
#include "base/state_quality.h"

namespace sf::base {

/// Hit value of a beam without an echo in range.
inline constexpr std::uint32_t kNoHit = 0xFFFFFFFFu;
/// Hit value of a beam of a spatial scan that meets the floor.
inline constexpr std::uint32_t kFloorHit = 0xFFFFFFFEu;

/// The reason why an element's error may exceed the error bound of its reading.
enum class QualityFlag : std::uint8_t {
  none = 0,          ///< the bound holds, if one is stated
  not_cast = 1,      ///< no beam was cast for this element: it is interpolated between cast beams
  grazing = 2,       ///< the beam hits a surface at too small an angle (SF_MIN_SINE, raycast/records.h)
  not_straight = 3,  ///< lane edge: the points do not lie on one straight line
  extrapolated = 4,  ///< lane edge: distance without a ray on the paint, extrapolated beyond the points
  too_near = 5       ///< range: the surface is nearer than the sensor's minimum (base/echo.h)
};

/// A set of sensor types: bit k for the type with wire id k, in [1, 63].
using SensorTypes = std::uint64_t;
constexpr SensorTypes only(std::uint8_t type) { return SensorTypes{1} << type; }

/// One reading of one sensor. The spans are valid until the next tick of the farm that returned them.
struct ReadingBlock {
  std::uint32_t mover = 0;              ///< row in `world::World::movers`
  std::uint32_t sensor = 0;             ///< 0-based among the mover's sensors of this type
  std::uint8_t type = 0;                ///< wire id of the sensor type
  std::uint32_t sequence = 0;           ///< number of this sensor's reading, from 0
  std::int64_t time = 0;                ///< [ns] simulated time of the measurement (not of its delivery)
  Pose X_WM;                            ///< the mover's pose at the measurement
  Tilt tilt;                            ///< of the mover at the measurement
  Pose X_WS;                            ///< the sensor's pose at the measurement, without tilt
  std::span<const double> values;       ///< element by element; within each, in the order of the sensor type's columns
  std::span<const std::uint32_t> hits;  ///< for scans computed in this process: row of the model that each beam hit,
                                        ///< kFloorHit or kNoHit; otherwise empty
  std::uint32_t flags = 0;              ///< bits defined by the header of the sensor type
  std::uint8_t mode = 0;                ///< accuracy mode of the measurement: row in the sensor type's modes
  /// [unit of the first column] largest error of that column in `values`, for elements without a quality flag
  /// (sensors/accuracy.h). Infinite when no bound is stated: for noisy readings, and when no element has a bound.
  double bound = std::numeric_limits<double>::infinity();
  double bound_without_noise = std::numeric_limits<double>::infinity();  ///< bound before noise was added
  /// [unit of the first column] largest standard deviation of its noise; 0: no noise; infinite: unknown.
  double sigma = 0.0;
  std::span<const QualityFlag> quality;  ///< one per element; empty: no element has a flag
  bool fused = false;                    ///< includes a reading of the robot's own sensor (server/reading_fusion.h)
  StateQuality state;  ///< quality of the mover's state at the measurement; not stated when the state is exact
};

/// Returns true when the sensor type's bound does not hold for every element: some have a quality flag or noise.
inline bool is_unsure(const ReadingBlock& reading) { return !reading.quality.empty() || reading.sigma > 0.0; }

}  // namespace sf::base
