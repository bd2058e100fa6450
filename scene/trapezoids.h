#pragma once
// Decomposition of flat regions into convex pieces.

#include <array>
#include <glm/ext/vector_double2.hpp>
#include <span>
#include <vector>

namespace sf::scene {

/// A directed edge of a region, which is on its left.
struct RegionEdge {
  glm::dvec2 a, b;
};

/// Corners of a trapezoid whose parallel sides are horizontal, counter-clockwise: lower left, lower right, upper right,
/// upper left. One of these sides may have a length of 0.
using Trapezoid = std::array<glm::dvec2, 4>;

/// Returns trapezoids that cover the points around which the edges wind at least once counter-clockwise, without
/// overlaps. Corners are ends of edges wherever possible. Edges that cross inside give rise to inexact pieces.
std::vector<Trapezoid> trapezoids_of(std::span<const RegionEdge> edges);

/// Divides edges where they cross, so that the pieces of trapezoids_of are exact to rounding.
std::vector<RegionEdge> split_at_crossings(std::span<const RegionEdge> edges);

}  // namespace sf::scene
