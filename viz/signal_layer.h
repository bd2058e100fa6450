#pragma once
// What tells robots something: traffic lights, infrared emitters; and the holes in the floor that cliff sensors tell
// of.

#include <vector>

#include "viz/axes.h"
#include "viz/legend.h"
#include "world/world.h"

namespace sf::viz {

/// Dark areas, beneath everything that stands.
void draw_floor_holes(Axes& axes, const world::World& world);

/// The beams and halos of virtual walls and docks, faint: without regard to what stands in their way.
void draw_emitters(Axes& axes, const world::World& world);

/// A disc each, in the colour it shows at `time` [s], and a short line towards those who see it.
void draw_lights(Axes& axes, const world::World& world, double time = 0.0);

/// What of these the world has.
std::vector<LegendItem> signals_legend(const world::World& world);
/// Lights alone, one item for each colour that one shows at `time` [s].
std::vector<LegendItem> lights_legend(const world::World& world, double time);

}  // namespace sf::viz
