#pragma once
// Outlines of road markings, for rays along the ground.
//
// A marking is the band within half its width of its line. The outline runs along the line's right side, across the
// end, back along the left side and across the start. At the line's vertices both sides meet on the bisector (a mitre),
// so the outline keeps exactly half the width from the line.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "world/world.h"

namespace sf::sensors {

/// One straight edge. The paint lies on the left of a -> b.
struct OutlineEdge {
  glm::dvec2 a;
  glm::dvec2 b;          ///< [m] world frame
  bool is_end = false;   ///< across the marking's line: not a lane edge
  bool is_solid = true;  ///< false: the outline intersects itself here, and the painted side is undefined
};

/// Appends the edges of one marking. A closed line has no end edges.
/// Precondition (World::lane_markings): at least two points, distinct neighbours, turns below 90 degrees.
void add_outline(const world::LaneMarking& marking, std::vector<OutlineEdge>& out);

/// Corners of a part of a marking, counter-clockwise: its right side, then its left side.
using Quad = std::array<glm::dvec2, 4>;
/// Appends one quad per piece of the marking's line. Together they are the band inside of the outline.
void add_quads(const world::LaneMarking& marking, std::vector<Quad>& out);

/// Removes duplicates, because two lanes paint their shared edge twice. Duplicates have equal width and points within
/// `within` [m], in either direction. The first one is kept.
std::vector<world::LaneMarking> distinct_markings(std::span<const world::LaneMarking> lane_markings,
                                                  double within = 1e-4);

}  // namespace sf::sensors
