#pragma once
// The ground layer: lane markings and magnets.

#include <vector>

#include "viz/axes.h"
#include "viz/legend.h"
#include "world/roads/network.h"
#include "world/world.h"

namespace sf::viz {

/// Draws lane markings, at least a pixel wide, in their colours on a band of asphalt, so that white ones are visible.
/// Lanes of the world's paths are asphalt from edge to edge.
void draw_lane_markings(Axes& axes, const world::World& world);

/// Draws lanes and exits as bands of lane width, and zones with their parking spots.
void draw_streets(Axes& axes, const world::RoadNetwork& roads);

/// Draws one dot per magnet: red if the north pole is up, blue if the south pole is up.
void draw_magnets(Axes& axes, const world::World& world);

/// Legend items for the objects of this layer in the world.
std::vector<LegendItem> road_legend(const world::World& world);

}  // namespace sf::viz
