#pragma once
// Heights of the ground: the floor at z = 0 or a terrain in its place, and roads above it (World::ramps). Bodies stand
// on these, and spatial sensors see them (scene/solids.h); planar sensors do not.

#include <optional>
#include <span>

#include "base/box_tree.h"
#include "base/pose.h"
#include "world/terrain.h"
#include "world/world.h"

namespace sf::world {

/// Immutable and thread-safe.
class Ground {
 public:
  /// Both must outlive it.
  explicit Ground(std::span<const Ramp> ramps, std::span<const Terrain> terrain = {});

  bool is_flat() const { return ramps_.empty() && !terrain_; }
  bool has_terrain() const { return terrain_.has_value(); }
  /// Returns the height [m] of the highest road at `p` that is at most `most` [m] high, or of the ground below.
  double height(glm::dvec2 p, double most) const { return at(p, most).z; }
  /// Same, with the slope there. Edges of roads and of the terrain are steps.
  /// @param radius [m] >= 0; > 0: the height is that of the lowest point of a wheel that stands at `p`, and rolls over
  /// edges at most `most` high as a ball does
  GroundPoint at(glm::dvec2 p, double most, double radius = 0.0) const;
  /// Returns the surface that the point `p` of a body meets: as `at` for heights up to `step` [m] above it. In terrain
  /// higher than that, it is the face of the cliff or border between `p` and the body's `middle`, or as far beyond `p`,
  /// extended to `p` as a plane; `at` without one, as in a body placed in the ground.
  GroundPoint contact(const glm::dvec3& p, glm::dvec2 middle, double step, double radius = 0.0) const;
  /// Returns the z [m] of a body after a move. On a surface (within 1 cm) it stays on it, and above a surface it keeps
  /// its height above it. It climbs a rise of a road of at most kMostStep plus kMostSlope times the length of the move,
  /// passes under higher roads, drops from an edge within the move, and follows terrain of any slope.
  double follow(const base::Pose& from, glm::dvec2 to) const;
  /// Returns the height [m] of a body above the surface that it stands on, or is above.
  double clearance(const Pose& X_WM) const { return X_WM.z - height({X_WM.x, X_WM.y}, X_WM.z + kContact); }
  /// Returns `to` as high above the ground, or the highest road, as `from` is above what it stands on.
  Pose stand(const Pose& from, const Pose& to) const;
  /// Returns the tilt of a robot on terrain: that of the plane through the contacts of its four wheels, at the corners
  /// of a rectangle about its origin (least squares). Zero in worlds without terrain.
  /// @param length, width [m] > 0, along and across its heading
  base::Tilt tilt(const base::Pose& at, double length, double width) const;

  static constexpr double kMostStep = 0.05;  ///< [m]
  static constexpr double kContact = 0.01;   ///< [m] a body this close to a surface is on it
  static constexpr double kMostSlope = 0.5;
  /// [half widths] Pieces are this much longer at both ends, level, which closes the gaps between them on the outside
  /// of bends.
  static constexpr double kOverlap = 0.05;

 private:
  GroundPoint base_at(glm::dvec2 p, double most = 0.0, double radius = 0.0) const;

  std::span<const Ramp> ramps_;
  std::optional<TerrainSurface> terrain_;
  base::BoxTree tree_;
};

/// Returns the height [m] of a mover at load above the surface below it.
double clearance_of(const World& world, const Mover& mover);
/// Returns the z [m] of a mover at `p` on the highest road of `world` there, with that clearance.
double height_on_road(const World& world, glm::dvec2 p, double clearance);

}  // namespace sf::world
