#include "world/stage/terrain_entity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "world/terrain.h"

namespace sf::world {

namespace {

constexpr double kMostHeight = 1e5;  // [m] of the surface, above or below the pose
constexpr double kLeastCell = 1e-3;  // [m]

glm::dvec2 heights_of(StageContext& context, const Entity& entity) {
  const SourceLocation at = location_of(entity, "heights");
  const auto heights = tuple(context, entity, "heights", 2, "[lowest highest]");
  if (!heights)
    fail(context, at, "a terrain needs 'heights [lowest highest]': those of black and white in its picture");
  const glm::dvec2 range{to_metres(context, at, (*heights)[0]), to_metres(context, at, (*heights)[1])};
  if (!(range.x <= range.y && std::max(std::abs(range.x), std::abs(range.y)) <= kMostHeight))
    fail(context, at,
         fmt::format("'heights' are {:g} to {:g} m; expected [lowest highest] within {:g} m", range.x, range.y,
                     kMostHeight));
  return range;
}

HeightMap map_of(StageContext& context, const Entity& entity, const std::string& file) {
  if (is_geotiff(file)) {
    if (find(entity, "heights") != nullptr)
      fail(context, location_of(entity, "heights"), "a GeoTIFF states its heights; expected no 'heights' here");
    return read_geotiff(file);
  }
  const glm::dvec2 heights = heights_of(context, entity);
  return read_height_map(file, heights.x, heights.y);
}

glm::dvec2 cell_of(StageContext& context, const Entity& entity, const HeightMap& map) {
  const SourceLocation at = location_of(entity, "size");
  const auto size = tuple(context, entity, "size", 2, "[x y]");
  if (!size && map.cell.x >= kLeastCell && map.cell.y >= kLeastCell) return map.cell;
  if (!size) fail(context, at, "a terrain needs 'size [x y]': the distances of its outermost points");
  const glm::dvec2 metres{to_metres(context, at, (*size)[0]), to_metres(context, at, (*size)[1])};
  const glm::dvec2 cell = metres / glm::dvec2(map.columns - 1, map.rows - 1);
  if (!(cell.x >= kLeastCell && cell.y >= kLeastCell))
    fail(context, at,
         fmt::format("'size' gives cells of {:g} m x {:g} m; expected at least {:g} m", cell.x, cell.y, kLeastCell));
  return cell;
}

}  // namespace

void read_terrain(BuildState& b, const Entity& root) {
  for (const Entity& entity : root.children) {
    if (entity_kind(entity.type) != EntityKind::terrain) continue;
    if (!b.world.terrain.empty())
      fail(b.context, entity.at, "a second 'terrain'; expected one per world: join the height maps");
    check_keys(b.context, entity, KeyScope::terrain);
    if (find(entity, "file") == nullptr) fail(b.context, entity.at, "a terrain needs 'file \"FILE\"': its height map");
    const std::string file = file_of(b.context, entity, "file");
    HeightMap map = map_of(b.context, entity, file);
    const glm::dvec2 cell = cell_of(b.context, entity, map);
    b.world.terrain.push_back(
        {file, pose(b.context, entity, "pose"), cell, map.columns, map.rows, std::move(map.heights)});
  }
}

double terrain_height(const World& world, glm::dvec2 p) {
  return world.terrain.empty() ? 0.0 : height_at(world.terrain[0], p).value_or(0.0);
}

}  // namespace sf::world
