#pragma once
// What a sensor says: one block per sensor that was due, in one shape for every kind.

#include <cstdint>
#include <limits>
#include <span>

#include "base/pose.h"

namespace sf::base {

/// Hit value of a beam that met nothing within range.
inline constexpr std::uint32_t kNoHit = 0xFFFFFFFFu;

/// Wire id of the laser: the one kind that modules beside `sensors` know by number, since controllers drive by it and
/// recordings keep it as ROS knows it.
inline constexpr std::uint8_t kLaser = 1;

/// Why an element's value may be wrong by more than its reading's bound.
enum class QualityFlag : std::uint8_t {
  none = 0,          ///< it is not
  not_cast = 1,      ///< no beam was cast for it: it lies between those that were
  grazing = 2,       ///< its beam meets a surface at too small an angle
  not_straight = 3,  ///< a lane edge whose points do not show one straight line
  extrapolated = 4   ///< a lane edge's distance where no ray met it: beyond the points it rests on
};

/// One reading of one sensor. The spans live until the next tick of the farm that returned them.
struct ReadingBlock {
  std::uint32_t mover = 0;         ///< row in `world::World::movers`
  std::uint32_t sensor = 0;        ///< 0-based among the mover's sensors of this kind
  std::uint8_t kind = 0;           ///< wire id of the kind
  std::uint32_t sequence = 0;      ///< counts this sensor's readings from 0
  std::int64_t time = 0;           ///< [ns] simulated time of the measurement (not of its delivery)
  Pose X_WM;                       ///< the mover's pose it was measured at
  Pose X_WS;                       ///< the sensor's pose it was measured at
  std::span<const double> values;  ///< laser: ranges [m], one per sample, in order of bearing from -fov/2 to +fov/2
  std::span<const std::uint32_t>
      hits;                 ///< laser: model row that each beam met, or kNoHit; empty where not known (interpolated)
  std::uint32_t flags = 0;  ///< what a kind has to say beside its values; which bits, its header tells
  std::uint8_t mode = 0;    ///< accuracy it was measured with: row of the kind's modes
  /// [unit of the first column] largest error of that column without noise, where `quality` says nothing
  /// (sensors/accuracy.h); infinite: none is stated.
  double bound = std::numeric_limits<double>::infinity();
  std::span<const QualityFlag> quality;  ///< one per element; empty: the bound holds for all
};

}  // namespace sf::base
