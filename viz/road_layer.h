#pragma once
// Lane markings and magnets: the layer of the ground.

#include <vector>

#include "viz/axes.h"
#include "viz/legend.h"
#include "world/roads/network.h"
#include "world/world.h"

namespace sf::viz {

/// Lane markings in their colours on a band of asphalt, so that white ones are visible; at least a pixel wide. Lanes of
/// the world's paths are asphalt from edge to edge.
void draw_lane_markings(Axes& axes, const world::World& world);

/// Lanes and exits as bands as wide as the lanes; zones with their parking spots.
void draw_streets(Axes& axes, const world::RoadNetwork& roads);

/// One dot per magnet: red with the north pole up, blue with the south pole up.
void draw_magnets(Axes& axes, const world::World& world);

/// Items for the parts of this layer in the world.
std::vector<LegendItem> road_legend(const world::World& world);

}  // namespace sf::viz
