#include "sensors/lane_markings/filtered_scene.h"

#include <algorithm>
#include <map>
#include <utility>

#include "base/error.h"
#include "sensors/lane_markings/outline.h"

namespace sf::sensors {

namespace {

constexpr double kAllHeights = 1e6;  // [m]
constexpr double kClearance = 0.05;  // [m] errors of heights

/// Heights [m] of the sensors that detect a marking.
using Heights = std::pair<double, double>;

/// Returns the height [m] of the highest lane edge sensor above its robot.
double highest_mount(const world::World& world) {
  double highest = 0.0;
  for (const world::Mover& mover : world.movers)
    for (const world::Sensor& sensor : mover.sensors)
      if (sensor.type == "laneedge") highest = std::max(highest, sensor.X_MS.z + 0.5 * sensor.height);
  return highest;
}

/// Groups the markings by the heights from which sensors detect them. Without ramps, every sensor detects every
/// marking. With ramps, a marking is visible from its road up to the mounting height of the highest sensor.
std::map<Heights, std::vector<world::LaneMarking>> by_height(const world::World& world) {
  if (world.ramps.empty()) return {{{-kAllHeights, kAllHeights}, world.lane_markings}};
  const double above = highest_mount(world) + kClearance;
  std::map<Heights, std::vector<world::LaneMarking>> sorted;
  for (std::size_t i = 0; i < world.lane_markings.size(); ++i) {
    const auto [low, high] = i < world.marking_heights.size() ? world.marking_heights[i] : world::MarkingHeights{};
    sorted[{low - kClearance, high + above}].push_back(world.lane_markings[i]);
  }
  return sorted;
}

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
  std::vector<Heights> heights;
  for (const auto& [visible, markings] : by_height(world)) {
    const std::vector<world::LaneMarking> distinct = distinct_markings(markings);
    e.paint.insert(e.paint.end(), distinct.begin(), distinct.end());
    heights.resize(e.paint.size(), visible);
  }

  for (const world::Segment& wall : world.walls) {
    if (!in_sight(wall)) continue;
    e.world.walls.push_back(wall);
    e.world.walls.back().model = grain_tag(e.grains, pixel_of(world, wall));
  }
  std::vector<OutlineEdge> outline;
  for (std::size_t i = 0; exact && i < e.paint.size(); ++i) {
    outline.clear();
    add_outline(e.paint[i], outline);
    for (const OutlineEdge& f : outline)
      e.world.walls.push_back({.a = f.a,
                               .b = f.b,
                               .z_min = heights[i].first,
                               .z_max = heights[i].second,
                               .model = f.is_end ? SF_TAG_END : 0u,
                               .solid_left = f.is_solid});
  }
  take_movers(world, e);
  return e;
}

void take_movers(const world::World& world, FilteredScene& scene) {
  scene.world.movers = world.movers;
  scene.world.copies = world.copies;
  for (world::Mover& mover : scene.world.movers)
    for (world::Segment& s : mover.body) s.model = SF_TAG_MOVER;
}

}  // namespace sf::sensors
