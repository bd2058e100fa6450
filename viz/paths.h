#pragma once
// Paths of drawings from lines, cut to the visible part, so that files are small and coordinates are in the range of
// their readers. All [px].

#include <span>

#include "viz/drawing.h"

namespace sf::viz {

/// A straight line between two points, in pixels or in metres.
struct Line {
  glm::dvec2 a;
  glm::dvec2 b;
};

struct PathBox {
  glm::dvec2 low, high;
};

/// Each line's part in `box`, successive lines that meet as one path. Lines with a number that is not finite are left
/// out.
Paths cut_lines(std::span<const Line> lines, const PathBox& box);

/// Closed outlines from their directed edges in any order. Edges with a number that is not finite are left out.
Paths join_edges(std::span<const Line> edges);

/// Closed outlines without what is outside `box`. Parts along its border may remain of those that leave it.
Paths cut_outlines(Paths outlines, const PathBox& box);

}  // namespace sf::viz
