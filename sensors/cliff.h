#pragma once
// Cliff sensors: points under a robot that detect the floor (docs/sensors.md).
//
// In a world file, inside a robot:
//   cliff( scount N  spose[0] [x y yaw] ... )
// Points are in the frame of their model and keep the order of the file. A reading has one row per point: 1 inside the
// outline of a drop-off (world::FloorHole), where there is no floor, else 0.

#include <cstdint>
#include <span>

#include "base/box_tree.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kCliff = 7;              ///< wire id
inline constexpr std::uint32_t kMostCliffPoints = 32;  ///< per sensor

extern const SensorType cliff_type;

/// Returns true when `p` is inside the closed polygon `outline`, of either winding. Each edge is decided by the sign of
/// one product: among polygons that share edges, exactly one contains a point on them.
bool holds(std::span<const glm::dvec2> outline, glm::dvec2 p);

/// Index of the holes of a world, which must outlive this object. Thread-safe.
class DropOffIndex {
 public:
  explicit DropOffIndex(std::span<const world::FloorHole> drops);
  /// Returns true when a hole contains `p`.
  bool hold(glm::dvec2 p) const;

 private:
  std::span<const world::FloorHole> drop_offs_;
  base::BoxTree boxes_;
};

}  // namespace sf::sensors
