#pragma once
// Decomposition of the solid cells of pictures into rectangles.

#include <optional>
#include <span>
#include <vector>

#include "scene/trapezoids.h"

namespace sf::scene {

/// Returns the pieces of trapezoids_of, as rectangles along the edges, for edges that are all parallel or perpendicular
/// to each other, up to rounding. Each corner is on an edge. Takes a time proportional to the lines of edges in one
/// direction times the edges across one of them.
/// @return nullopt for other edges, and for those so far from the origin that rounding hides their order
std::optional<std::vector<Trapezoid>> rectangles_of(std::span<const RegionEdge> edges);

}  // namespace sf::scene
