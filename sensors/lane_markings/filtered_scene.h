#pragma once
// The subset of a world that lane edge sensors detect. Segments carry the tags of sensors/laneedge.h.

#include <vector>

#include "sensors/laneedge.h"
#include "world/world.h"

namespace sf::sensors {

/// Contains lane markings, either as exact outlines or not at all; static walls that lasers and lane edge sensors
/// detect; and movers, as occluders.
struct FilteredScene {
  world::World world;                     ///< walls and movers; `Segment::model` is a tag
  std::vector<double> grains;             ///< [m] pixel sizes, ascending; the first is 0
  std::uint32_t paint_tag = 0;            ///< tag of markings in a raster of road_resolution
  std::vector<world::LaneMarking> paint;  ///< distinct markings of the road
};

/// Builds the filtered scene. @param exact true: markings become walls, at the heights of the sensors on their road;
/// false: markings are left to the raster
/// @throws base::InputError when bitmaps have more pixel sizes than a point's tag can encode
FilteredScene filter_scene(const world::World& world, bool exact);
/// Replaces the movers of a filtered scene by those of `world`.
void take_movers(const world::World& world, FilteredScene& scene);

}  // namespace sf::sensors
