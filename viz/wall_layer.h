#pragma once
// The static part of a world on a figure.

#include <vector>

#include "viz/axes.h"
#include "world/world.h"

namespace sf::viz {

enum class WallColors {
  of_models,  ///< blocks in their own colours, floor plans in slate
  quiet       ///< all in light grey, behind something that matters more
};

/// Solids filled, outlines drawn: full where they stop robots, dashed where they do not, dotted grey where a laser does
/// not see them; faint and dashed what is above every mover's head (bridges, crowns of trees).
void draw_walls(Axes& axes, const world::World& world, WallColors colors);

/// One item per kind of wall that the world has.
std::vector<LegendItem> wall_legend(const world::World& world, WallColors colors);

}  // namespace sf::viz
