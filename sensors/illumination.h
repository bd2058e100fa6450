#pragma once
// The light of a world's lamps at a point, with shadows (docs/sensors.md).

#include "base/box_tree.h"
#include "world/wall_tree.h"
#include "world/world.h"

namespace sf::sensors {

inline constexpr double kFaintest = 1e-3;     ///< [lx] lamps count where they give this or more
inline constexpr double kNearestLamp = 0.01;  ///< [m] smaller distances count as this one

/// Returns the illuminance [lx] of a lamp on a vertical surface at `p` [m] (world) that faces `normal` (unit length):
/// I cos(incidence) / r^2. 0 behind the surface, outside the lamp's beam, or where I / r^2 is below kFaintest. Ignores
/// walls.
double illuminance_of(const world::Lamp& lamp, const glm::dvec3& p, glm::dvec2 normal);

/// Returns true when the straight line from `from` to `to` crosses the wall within its heights. A line along the wall
/// passes.
bool crosses_sight(const glm::dvec3& from, const glm::dvec3& to, const world::Segment& wall);

/// Returns the distance [m] beyond which no lamp of the world counts.
double reach_of_lamps(const world::World& world);

/// The light of a world, which must outlive this object. Thread-safe.
class Illumination {
 public:
  explicit Illumination(const world::World& world);
  /// Returns the illuminance [lx] on an element at X_SE of a sensor at X_WS, a vertical surface that faces along its x:
  /// ambient light and all lamps that no wall hides.
  double at(const base::Pose& X_WS, const base::Pose& X_SE) const;

 private:
  const world::World& world_;
  world::WallTree walls_;  ///< those that lasers see
  base::BoxTree reaches_;  ///< of the lamps
};

}  // namespace sf::sensors
