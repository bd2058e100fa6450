#pragma once
// Traffic lights, infrared emitters and holes in the floor.

#include <span>
#include <vector>

#include "viz/axes.h"
#include "viz/legend.h"
#include "world/world.h"

namespace sf::viz {

/// Dark areas, drawn beneath walls and movers.
void draw_floor_holes(Axes& axes, const world::World& world);

/// The beams and halos of virtual walls and docks, faint, without occlusion by walls.
void draw_emitters(Axes& axes, const world::World& world);

/// One mark per light in its state at `time` [s]: a dot for green, a diamond for yellow, a square for red, hollow ones
/// for flashing, a crossed dot for dark; with a short line in the direction of its lamps.
void draw_lights(Axes& axes, const world::World& world, double time = 0.0);
/// The same with one state per light, as a run had them.
void draw_lights(Axes& axes, const world::World& world, std::span<const world::LightState> states);

/// Items for the parts of this layer in the world; lights as at time 0.
std::vector<LegendItem> signal_layer_legend(const world::World& world);
/// The mark of a light in one state, "light, green".
LegendItem signal_legend_item(world::LightState state);
/// Items for lights alone, one per state shown at `time` [s].
std::vector<LegendItem> lights_legend(const world::World& world, double time);

}  // namespace sf::viz
