#include "world/stage/road_entities.h"

#include <fmt/format.h>

#include <algorithm>

#include "world/roads/roads.h"
#include "world/stage/magnet_row.h"

namespace sf::world {

namespace {

constexpr double kMaxRoads = 100;

RoadNetwork read_network(BuildState& b, const Entity& entity) {
  const Property* rndf = find(entity, "rndf");
  const std::string name = text(b.context, entity, "rndf", "");
  if (rndf == nullptr || name.empty()) fail(b.context, entity.at, "a road requires its network: rndf \"FILE\"");
  const std::string file = find_file(b.context.document, rndf->at, name);
  if (file.empty())
    fail(b.context, rndf->at,
         fmt::format("cannot find the road network \"{}\"; searched the folders of this file and of the world file, "
                     "$STAGEPATH and the installed worlds",
                     name));
  return load_roads(file, b.context.warnings, b.options.strict);
}

/// Returns the lanes in a list such as "1.1 3.2", or all for "all".
std::vector<const RoadLane*> named_lanes(const BuildState& b, const Entity& entity, const RoadNetwork& roads) {
  const std::string names = fmt::format(" {} ", text(b.context, entity, "magnet_lanes", "all"));
  std::vector<const RoadLane*> lanes;
  for (const RoadLane& lane : roads.lanes)
    if (names == " all " || names.find(fmt::format(" {} ", lane_name(roads, lane))) != std::string::npos)
      lanes.push_back(&lane);
  const auto words = static_cast<std::size_t>(std::count(names.begin(), names.end(), ' ')) - 1;
  if (names != " all " && lanes.size() != words)
    fail(b.context, find(entity, "magnet_lanes")->at,
         fmt::format("'magnet_lanes' is \"{}\"; expected \"all\", or lanes that {} has, such as \"1.1 1.2\"",
                     text(b.context, entity, "magnet_lanes", ""), roads.file));
  return lanes;
}

void register_way_points(BuildState& b, const RoadNetwork& roads) {
  for (const RoadLane& lane : roads.lanes)
    for (const LanePoint& point : lane.points) b.way_points.try_emplace(point_id_text(point.id), false);
  for (const StopLine& stop : roads.stops) b.way_points[point_id_text(id_of(roads, stop.at))] = true;
}

void add_paint(World& world, const RoadNetwork& roads) {
  std::vector<MarkingHeights> heights;
  const std::vector<LaneMarking> paint = lane_markings_of(roads, &heights);
  const std::vector<Ramp> ramps = ramps_of(roads);
  if (!ramps.empty()) {
    world.ramps.insert(world.ramps.end(), ramps.begin(), ramps.end());
    world.marking_heights.resize(world.lane_markings.size());
    world.marking_heights.insert(world.marking_heights.end(), heights.begin(), heights.end());
  }
  world.lane_markings.insert(world.lane_markings.end(), paint.begin(), paint.end());
}

}  // namespace

void add_road(BuildState& b, const Entity& entity) {
  check_keys(b.context, entity, KeyScope::road);
  charge(b.context, entity.at, b.context.usage.roads, 1.0, kMaxRoads, "road networks", "join them into one file");
  const RoadNetwork roads = read_network(b, entity);
  Model model;
  model.name = text(b.context, entity, "name", roads.name.empty() ? "road" : roads.name);
  while (!b.names.insert(model.name).second) model.name += "#";
  model.type = "road";
  b.world.models.push_back(model);
  b.world.road_files.push_back(roads.file);
  register_way_points(b, roads);
  add_paint(b.world, roads);

  const auto row = read_magnet_row(b.context, entity);
  if (!row) return;
  for (const RoadLane* lane : named_lanes(b, entity, roads))
    place_magnets(b, entity, *row, length_of(*lane), [&](double s) {
      const glm::dvec2 p = point_at(lane->centre, s);
      return Pose{p.x, p.y, height_at(*lane, s), 0.0};
    });
}

}  // namespace sf::world
