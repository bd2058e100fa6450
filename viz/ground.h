#pragma once
// What lies on and in the ground: road paint and magnets.

#include <vector>

#include "viz/axes.h"
#include "viz/legend.h"
#include "world/world.h"

namespace sf::viz {

/// Stripes in their colours on a band of asphalt, so that white ones are seen; at least a pixel wide.
void draw_paint(Axes& axes, const world::World& world);

/// A dot each, red where the north pole is up, blue where the south pole is.
void draw_magnets(Axes& axes, const world::World& world);

/// What of these the world has.
std::vector<LegendItem> ground_legend(const world::World& world);

}  // namespace sf::viz
