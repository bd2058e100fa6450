#pragma once
// Traffic lights, infrared emitters and holes in the floor.

#include <vector>

#include "viz/axes.h"
#include "viz/legend.h"
#include "world/world.h"

namespace sf::viz {

/// Dark areas, drawn beneath walls and movers.
void draw_floor_holes(Axes& axes, const world::World& world);

/// The beams and halos of virtual walls and docks, faint, without occlusion by walls.
void draw_emitters(Axes& axes, const world::World& world);

/// One disc per light, in its colour at `time` [s], with a short line in the direction of its lamps.
void draw_lights(Axes& axes, const world::World& world, double time = 0.0);

/// Items for the parts of this layer in the world.
std::vector<LegendItem> signals_legend(const world::World& world);
/// Items for lights alone, one per colour shown at `time` [s].
std::vector<LegendItem> lights_legend(const world::World& world, double time);

}  // namespace sf::viz
