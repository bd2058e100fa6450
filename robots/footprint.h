#pragma once
// A mover's footprint, and whether it touches a wall or another footprint. Two things touch only where their ranges of
// heights overlap, so a low robot passes under a bridge.

#include <span>
#include <vector>

#include "base/pose.h"
#include "world/world.h"

namespace sf::robots {

struct FootprintEdge {
  glm::dvec2 a;
  glm::dvec2 b;
  double z_min = 0.0;
  double z_max = 0.0;  ///< [m] exclusive
  bool solid = true;   ///< part of a closed outline, the inside on the left of a -> b
};

/// The part of a mover's body that stops at things. No edges: it passes through everything.
struct Footprint {
  std::vector<FootprintEdge> edges;  ///< [m] mover frame
  double radius = 0.0;               ///< [m] of the circle about the origin that holds the edges
  double z_min = 0.0;
  double z_max = 0.0;  ///< [m] of all edges
  double step = 0.0;   ///< [m] > 0, farthest any point of it may travel between two tests
};

/// `step` is a quarter of the inradius about the origin of the outline that holds the origin (radius / 16 where none
/// does): no wall is jumped at the heights of that outline. Smaller parts carried on it are tested at the same steps.
Footprint footprint_of(const world::Mover& mover);

/// Whether `p` is inside the solid outlines among `edges` that stand somewhere between the heights z_min and z_max [m].
/// By winding number (Sunday, "Inclusion of a point in a polygon", 2001).
bool inside(std::span<const FootprintEdge> edges, glm::dvec2 p, double z_min, double z_max);

/// An outline put somewhere. Coordinates are relative to `origin`, so that they are as exact far from the world's
/// origin.
struct PlacedFootprint {
  glm::dvec2 origin;    ///< [m] world frame
  double radius = 0.0;  ///< [m]
  std::span<const FootprintEdge>
      edges;  ///< turned and lifted, relative to `origin`; lives as long as the memory given to `place`
};

/// @param memory keeps the turned edges; at least as many as the outline has
PlacedFootprint place_footprint(const Footprint& outline, const base::Pose& X_WM, std::span<FootprintEdge> memory);

/// Crosses, touches, or has the wall's end inside. A wall's own solid side is not looked at.
bool touches(const PlacedFootprint& placed, const world::Segment& wall);

/// Edges meet, or one is inside the other.
bool touches(const PlacedFootprint& p, const PlacedFootprint& q);

}  // namespace sf::robots
