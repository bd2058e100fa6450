#pragma once
// Traffic lights, infrared emitters, lamps and holes in the floor.

#include <span>
#include <vector>

#include "viz/axes.h"
#include "viz/legend.h"
#include "world/world.h"

namespace sf::viz {

/// Draws dark areas beneath walls and movers.
void draw_floor_holes(Axes& axes, const world::World& world);

/// Draws the beams and halos of virtual walls and docks, faintly and without occlusion by walls, and lamps as suns with
/// rays over their beams.
void draw_emitters(Axes& axes, const world::World& world);

/// Draws one mark per light in its state at `time` [s]: a dot for green, a diamond for yellow, a square for red, hollow
/// marks for flashing, a crossed dot for dark. A short line shows the direction of its lamps.
void draw_lights(Axes& axes, const world::World& world, double time = 0.0);
/// The same with one state per light, taken from a run. @param X_WM one per mover, of lights that join; empty: those
/// are not drawn
void draw_lights(Axes& axes, const world::World& world, std::span<const world::LightState> states,
                 std::span<const base::Pose> X_WM = {});

/// Legend items for the objects of this layer in the world; lights as at time 0.
std::vector<LegendItem> signal_layer_legend(const world::World& world);
/// Returns the legend item of a light in one state, "light, green".
LegendItem signal_legend_item(world::LightState state);
/// Legend items for the lights only, one per state shown at `time` [s].
std::vector<LegendItem> lights_legend(const world::World& world, double time);

}  // namespace sf::viz
