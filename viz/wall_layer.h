#pragma once
// Draws the static part of a world.

#include <vector>

#include "viz/axes.h"
#include "world/world.h"

namespace sf::viz {

enum class WallColors {
  of_models,  ///< blocks in their own colours, floor plans in slate
  quiet       ///< light grey, behind more important layers
};

/// Fills solids and draws outlines: solid lines for walls that stop robots, dashed ones for walls that do not, dotted
/// grey ones for walls invisible to lasers, faint dashed ones for walls above all movers (bridges, tree crowns).
void draw_walls(Axes& axes, const world::World& world, WallColors colors);

/// Returns one legend item per kind of wall in the world.
std::vector<LegendItem> wall_legend(const world::World& world, WallColors colors);

}  // namespace sf::viz
