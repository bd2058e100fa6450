#pragma once
// What lies on and in the ground: road paint and magnets.

#include <vector>

#include "viz/axes.h"
#include "viz/legend.h"
#include "world/roads/network.h"
#include "world/world.h"

namespace sf::viz {

/// Stripes in their colours on a band of asphalt, so that white ones are seen; at least a pixel wide. Lanes that the
/// world has as paths are asphalt from edge to edge.
void draw_paint(Axes& axes, const world::World& world);

/// Lanes, and the ways over crossings, as bands as wide as the lanes; zones with their parking spots.
void draw_streets(Axes& axes, const world::RoadNetwork& roads);

/// A dot each, red where the north pole is up, blue where the south pole is.
void draw_magnets(Axes& axes, const world::World& world);

/// What of these the world has.
std::vector<LegendItem> road_legend(const world::World& world);

}  // namespace sf::viz
