#pragma once
// A mover's footprint, and its contacts with walls and other footprints. Two surfaces touch only if their height ranges
// overlap, so a low robot passes under a bridge.

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
  bool solid = true;   ///< part of a closed outline whose inside is on the left of a -> b
};

/// The colliding part of a mover's body. Without edges it passes through everything.
struct Footprint {
  std::vector<FootprintEdge> edges;  ///< [m] mover frame
  double radius = 0.0;               ///< [m] radius of the circle about the origin that contains the edges
  double z_min = 0.0;
  double z_max = 0.0;  ///< [m] over all edges
  double step = 0.0;   ///< [m] > 0, largest travel of any point between two tests
  double inner =
      0.0;  ///< [m] radius of a disc about the origin that is solid at the heights of the first edge; 0: none
};

/// Returns true if the inner discs of two footprints certainly overlap, so that the footprints touch.
/// @param apart [m] distance of their origins
/// @param lift [m] height of the other above this one
bool surely_overlap(const Footprint& one, const Footprint& other, double apart, double lift);

/// Returns the footprint of a mover. `step` is a quarter of the inradius, about the origin, of the outline that
/// contains the origin (radius / 16 if none does), so no wall is skipped at the heights of that outline. Smaller parts
/// of the mover are tested at the same steps.
Footprint footprint_of(const world::Mover& mover);

/// Returns whether `p` is inside the solid outlines among `edges` whose heights overlap [z_min, z_max] [m]. Uses the
/// winding number (Sunday, "Inclusion of a point in a polygon", 2001).
bool inside(std::span<const FootprintEdge> edges, glm::dvec2 p, double z_min, double z_max);

/// An outline at a pose. Coordinates are relative to `origin`, to keep precision far from the world's origin.
struct PlacedFootprint {
  glm::dvec2 origin;    ///< [m] world frame
  double radius = 0.0;  ///< [m]
  std::span<const FootprintEdge>
      edges;  ///< rotated and lifted, relative to `origin`; points into the memory given to place_footprint
};

/// Rotates and lifts the edges of `outline` into `memory`.
/// @param memory at least as many edges as the outline has
PlacedFootprint place_footprint(const Footprint& outline, const base::Pose& X_WM, std::span<FootprintEdge> memory);

/// Returns whether the outline crosses or touches the wall, or contains one of its ends. Ignores `Segment::solid_left`.
bool touches(const PlacedFootprint& placed, const world::Segment& wall);

/// Returns whether edges meet or one outline is inside the other.
bool touches(const PlacedFootprint& p, const PlacedFootprint& q);

}  // namespace sf::robots
