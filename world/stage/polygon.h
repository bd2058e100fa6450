#pragma once
// Polygons of the world file as outlines with known sides.

#include <optional>
#include <vector>

#include "base/pose.h"

namespace sf::world {

struct PolygonEdge {
  glm::dvec2 a;
  glm::dvec2 b;  ///< never equal to a
};

/// Invariant: with `solid_left`, the edges are a simple closed polygon, counter-clockwise.
struct Polygon {
  std::vector<PolygonEdge> edges;
  bool solid_left = true;
};

/// Closes the polygon through `points` (either winding; repeated neighbours are dropped). Two points give one thin
/// wall; fewer points give nothing. A polygon that crosses or touches itself, or has no area, keeps its edges without
/// `solid_left`.
Polygon make_polygon(std::vector<glm::dvec2> points);

/// Same, with bounded work. Compares all pairs of edges whose extents along x overlap: at most half the square of the
/// number of edges.
/// @param pairs of edges that may still be compared; reduced by the number of compared pairs
/// @return nothing if more pairs would have to be compared
std::optional<Polygon> make_polygon(std::vector<glm::dvec2> points, double& pairs);

}  // namespace sf::world
