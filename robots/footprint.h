#pragma once
// A mover's footprint, and its contacts with walls and other footprints. Two surfaces touch only when their height
// ranges overlap, so a low robot passes under a bridge.

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
  bool solid = true;   ///< part of a closed outline with the inside on the left of a -> b
};

/// The part of a mover's body that collides. Without edges it passes through everything.
struct Footprint {
  std::vector<FootprintEdge> edges;  ///< [m] mover frame
  double radius = 0.0;               ///< [m] of the circle about the origin that holds the edges
  double z_min = 0.0;
  double z_max = 0.0;  ///< [m] of all edges
  double step = 0.0;   ///< [m] > 0, largest travel of any of its points between two tests
  double inner =
      0.0;  ///< [m] radius of a disc about the origin that is solid at the heights of the first edge; 0: none
};

/// True where the inner discs of two footprints surely overlap, so that these touch. @param apart [m] of their origins
/// @param lift [m] of the other above this one
bool surely_overlap(const Footprint& one, const Footprint& other, double apart, double lift);

/// Footprint of a mover. `step` is a quarter of the inradius, about the origin, of the outline that holds the origin
/// (radius / 16 when none does), so no wall is skipped at the heights of that outline. Smaller parts on the mover are
/// tested at the same steps.
Footprint footprint_of(const world::Mover& mover);

/// Whether `p` is inside the solid outlines among `edges` whose heights overlap [z_min, z_max] [m]. By winding number
/// (Sunday, "Inclusion of a point in a polygon", 2001).
bool inside(std::span<const FootprintEdge> edges, glm::dvec2 p, double z_min, double z_max);

/// An outline at a pose. Coordinates are relative to `origin`, for the same precision far from the world's origin.
struct PlacedFootprint {
  glm::dvec2 origin;    ///< [m] world frame
  double radius = 0.0;  ///< [m]
  std::span<const FootprintEdge>
      edges;  ///< rotated and lifted, relative to `origin`; lives as long as the memory given to place_footprint
};

/// @param memory for the rotated edges; at least as many as the outline has
PlacedFootprint place_footprint(const Footprint& outline, const base::Pose& X_WM, std::span<FootprintEdge> memory);

/// Whether the outline crosses or touches the wall, or holds one of its ends. `Segment::solid_left` is ignored.
bool touches(const PlacedFootprint& placed, const world::Segment& wall);

/// Whether edges meet, or one outline is inside the other.
bool touches(const PlacedFootprint& p, const PlacedFootprint& q);

}  // namespace sf::robots
