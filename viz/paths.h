#pragma once
// Builds the paths of drawings from lines and clips them to the visible part, which keeps files small and coordinates
// within the range of readers. All [px].

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

/// Returns the part of each line in `box`; successive lines that meet form one path. Skips lines with numbers that are
/// not finite.
Paths cut_lines(std::span<const Line> lines, const PathBox& box);

/// Joins directed edges in any order to closed outlines. Skips edges with numbers that are not finite.
Paths join_edges(std::span<const Line> edges);

/// Clips closed outlines to `box`. Outlines that leave the box may keep parts along its border.
Paths cut_outlines(Paths outlines, const PathBox& box);

}  // namespace sf::viz
