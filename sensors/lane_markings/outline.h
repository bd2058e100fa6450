#pragma once
// The faces of road paint: what a ray along the ground meets of a stripe.
//
// A stripe is the band within half its width of its line: its outline runs along the line's right side, over the end,
// back along the left side and over the start. Where the line turns, both sides turn in the bisector of the two pieces
// (a mitre), so that the outline's faces keep exactly half the width from the line.

#include <cstdint>
#include <span>
#include <vector>

#include "world/world.h"

namespace sf::sensors {

/// One straight face. The paint lies on the left of a -> b.
struct OutlineEdge {
  glm::dvec2 a;
  glm::dvec2 b;          ///< [m] world frame
  bool is_end = false;   ///< across the stripe's line: not a lane edge
  bool is_solid = true;  ///< false: the outline crosses itself here, and nothing is known about sides
};

/// Faces of one stripe. A line that ends where it began has no end faces.
/// Rule (World::lane_markings): at least two points, neighbours distinct, turns below 90 degrees.
void add_outline(const world::LaneMarking& marking, std::vector<OutlineEdge>& out);

/// The stripes without those that lie on another: two lanes paint the edge that they share twice. Same width, same
/// points within `within` [m], in either direction; the first of each stays.
std::vector<world::LaneMarking> distinct_markings(std::span<const world::LaneMarking> lane_markings,
                                                  double within = 1e-4);

}  // namespace sf::sensors
