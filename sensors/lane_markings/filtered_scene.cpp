#include "sensors/lane_markings/filtered_scene.h"

#include <algorithm>

#include "base/error.h"
#include "sensors/lane_markings/outline.h"

namespace sf::sensors {

namespace {

/// Markings have no height of their own, so every lane edge sensor detects them.
constexpr double kAllHeights = 1e6;  // [m]

/// Returns the pixel size of a wall's outline [m]; 0 if it has none.
double pixel_of(const world::World& world, const world::Segment& wall) {
  return wall.model < world.models.size() && world.models[wall.model].is_bitmap ? world.models[wall.model].pixel : 0.0;
}

std::uint32_t grain_tag(const std::vector<double>& grains, double pixel) {
  const auto found = std::lower_bound(grains.begin(), grains.end(), pixel);
  return static_cast<std::uint32_t>(found - grains.begin()) << SF_TAG_BITS;
}

bool in_sight(const world::Segment& wall) { return wall.seen_by_laser && wall.seen_by_laneedge; }

}  // namespace

FilteredScene filter_scene(const world::World& world, bool exact) {
  FilteredScene e;
  e.grains = {0.0};
  for (const world::Segment& wall : world.walls)
    if (in_sight(wall)) e.grains.push_back(pixel_of(world, wall));
  if (!exact) e.grains.push_back(world.road_resolution);
  std::sort(e.grains.begin(), e.grains.end());
  e.grains.erase(std::unique(e.grains.begin(), e.grains.end()), e.grains.end());
  if (e.grains.size() > SF_GRAIN_MASK)
    throw base::InputError(world.file, 0,
                           "the world's bitmaps have " + std::to_string(e.grains.size()) +
                               " different sizes of pixels; lane edge sensors distinguish at most 254");
  e.paint_tag = exact ? 0 : grain_tag(e.grains, world.road_resolution);
  e.paint = distinct_markings(world.lane_markings);

  for (const world::Segment& wall : world.walls) {
    if (!in_sight(wall)) continue;
    e.world.walls.push_back(wall);
    e.world.walls.back().model = grain_tag(e.grains, pixel_of(world, wall));
  }
  std::vector<OutlineEdge> outline;
  for (const world::LaneMarking& marking : e.paint)
    if (exact) add_outline(marking, outline);
  for (const OutlineEdge& f : outline)
    e.world.walls.push_back({.a = f.a,
                             .b = f.b,
                             .z_min = -kAllHeights,
                             .z_max = kAllHeights,
                             .model = f.is_end ? SF_TAG_END : 0u,
                             .solid_left = f.is_solid});
  e.world.movers = world.movers;
  for (world::Mover& mover : e.world.movers)
    for (world::Segment& s : mover.body) s.model = SF_TAG_MOVER;
  return e;
}

}  // namespace sf::sensors
