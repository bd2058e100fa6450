#pragma once
// The subset of a world that lane edge sensors see. Segments carry the tags of sensors/laneedge.h.

#include <vector>

#include "sensors/laneedge.h"
#include "world/world.h"

namespace sf::sensors {

/// Lane markings as exact outlines or not at all; static walls that lasers and lane edge sensors see; movers, as
/// occluders.
struct FilteredScene {
  world::World world;                     ///< walls and movers; `Segment::model` is a tag
  std::vector<double> grains;             ///< [m] pixel sizes, ascending; the first is 0
  std::uint32_t paint_tag = 0;            ///< tag of markings in a raster of road_resolution
  std::vector<world::LaneMarking> paint;  ///< the distinct markings of the road
};

/// @param exact true: markings become walls, at every height; false: they are left to the raster
/// @throws base::InputError where bitmaps have more pixel sizes than a point's tag can encode
FilteredScene filter_scene(const world::World& world, bool exact);

}  // namespace sf::sensors
