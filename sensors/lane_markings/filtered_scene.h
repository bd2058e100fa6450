#pragma once
// What lane edge sensors may see of a world, as a world of its own whose segments say what a ray met in the words of
// sensors/laneedge.h.

#include <vector>

#include "sensors/laneedge.h"
#include "world/world.h"

namespace sf::sensors {

/// Stripes exactly, or none of them; static walls that lasers and lane edge sensors see; movers, which hide what is
/// behind them.
struct FilteredScene {
  world::World world;                     ///< walls and movers; `Segment::model` is a tag
  std::vector<double> grains;             ///< [m] pixel sizes by row, rising; the first is 0
  std::uint32_t paint_tag = 0;            ///< of a raster of road_resolution
  std::vector<world::LaneMarking> paint;  ///< the distinct stripes of the road
};

/// @throws base::InputError where bitmaps have more sizes of pixels than a point's grain can say.
/// @param exact whether stripes become walls, at every height; else they are left to the raster.
FilteredScene filter_scene(const world::World& world, bool exact);

}  // namespace sf::sensors
