#include "bridges/view_solids.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <utility>

#include "bridges/view_clouds.h"
#include "record/cdr.h"
#include "scene/solids.h"
#include "world/ground.h"
#include "world/terrain.h"

namespace sf::bridges {

namespace {

using world::Segment;
using world::World;

constexpr std::uint32_t kRoadColor = 0xFF808890u, kTerrainColor = 0xFFA3AD94u;

/// One use of a solid.
struct Place {
  std::uint32_t mover = world::kNone;  ///< whose frame `X` is in; kNone: the world's
  base::Pose X;
  std::uint32_t color = 0;  ///< 0xAARRGGBB; 0: the mover's, or the theme's
};

void put_solid(record::CdrWriter& cdr, std::string_view kind, const scene::Mesh& mesh, glm::dvec3 origin,
               std::span<const Place> places) {
  cdr.put(kind);
  cdr.put_count(3 * mesh.vertices.size());
  for (const glm::dvec3& vertex : mesh.vertices)
    for (int axis = 0; axis < 3; ++axis) cdr.put(static_cast<float>(vertex[axis] - origin[axis]));
  std::size_t triangles = 0;
  for (const scene::Face& face : mesh.faces) triangles += scene::corners_of(face) - 2;
  cdr.put_count(3 * triangles);
  for (const scene::Face& face : mesh.faces)
    for (std::uint32_t k = 2; k < scene::corners_of(face); ++k)
      for (const std::uint32_t corner : {face[0], face[k - 1], face[k]}) cdr.put(corner);
  cdr.put_count(places.size());
  for (const Place& place : places) {
    cdr.put(place.mover);
    for (const double value : {place.X.x, place.X.y, place.X.z, place.X.yaw}) cdr.put(value);
    cdr.put(place.color);
  }
}

/// The walls that are sent, by kind and colour, each group in the order of the world.
std::map<std::pair<std::string, std::uint32_t>, std::vector<Segment>> wall_groups(const World& world, double headroom) {
  const std::vector<std::uint8_t> as_mesh = models_in_view_as_mesh(world);
  std::map<std::pair<std::string, std::uint32_t>, std::vector<Segment>> groups;
  for (const Segment& s : std::span(world.walls).first(std::min(world.walls.size(), kMostViewWalls))) {
    const bool known = s.model < world.models.size();
    if (known && as_mesh[s.model] != 0) continue;
    const std::uint32_t color = known && !world.models[s.model].is_bitmap ? world.models[s.model].color : 0;
    groups[{wall_kind(s, headroom), color}].emplace_back(s).seen_by_laser = true;  // drawn, too
  }
  return groups;
}

/// Movers change their colours at run time, and the viewer has them.
Place place_of(const World& world, const world::MeshModel& row) {
  const world::Model& model = world.models[row.model];
  return {model.mover, row.X_BF, model.mover == world::kNone ? model.color : 0};
}

/// Returns the number of points along a side of a height map in steps that include both ends.
std::size_t points_along(std::uint32_t points, std::uint32_t step) { return (points - 2) / step + 2; }

std::uint32_t step_of(const world::Terrain& terrain) {
  std::uint32_t step = 1;
  while (points_along(terrain.columns, step) * points_along(terrain.rows, step) > kMostViewHeights) ++step;
  return step;
}

/// Returns the surface of every so many-th height, in the frame of its corner.
scene::Mesh mesh_of(const world::Terrain& terrain, std::uint32_t step) {
  const auto columns = static_cast<std::uint32_t>(points_along(terrain.columns, step));
  const auto rows = static_cast<std::uint32_t>(points_along(terrain.rows, step));
  scene::Mesh mesh;
  for (std::uint32_t row = 0; row < rows; ++row)
    for (std::uint32_t column = 0; column < columns; ++column) {
      const std::size_t i = std::min(column * step, terrain.columns - 1), j = std::min(row * step, terrain.rows - 1);
      mesh.vertices.emplace_back(static_cast<double>(i) * terrain.cell.x, static_cast<double>(j) * terrain.cell.y,
                                 terrain.heights[j * terrain.columns + i]);
      if (row + 1 == rows || column + 1 == columns) continue;
      const std::uint32_t k = row * columns + column, above = k + columns;
      mesh.faces.push_back({k, k + 1, above + 1, above + 1});
      mesh.faces.push_back({k, above + 1, above, above});
    }
  return mesh;
}

/// Tells users what the view omits. Empty if it shows the whole world.
std::string note_of(const World& world, const std::vector<std::uint8_t>& as_mesh) {
  std::string note;
  if (world.walls.size() > kMostViewWalls)
    note = fmt::format("the first {} of {} walls", kMostViewWalls, world.walls.size());
  std::size_t missing = 0;
  for (const world::MeshModel& row : world.mesh_models) missing += as_mesh[row.model] == 0;
  if (missing > 0)
    note += fmt::format("{}{} models as prisms: their meshes have more than {} triangles in all",
                        note.empty() ? "" : "; ", missing, kMostViewTriangles);
  for (const world::Terrain& terrain : world.terrain)
    if (const std::uint32_t step = step_of(terrain); step > 1)
      note += fmt::format("{}terrain in steps of {} points", note.empty() ? "" : "; ", step);
  return note;
}

}  // namespace

double headroom_of(const World& world) {
  double top = world.movers.empty() ? std::numeric_limits<double>::infinity() : 0.0;
  for (const world::Mover& mover : world.movers)
    for (const Segment& s : mover.body) top = std::max(top, world::clearance_of(world, mover) + s.z_max);
  return top;
}

const char* wall_kind(const Segment& wall, double headroom) {
  if (wall.z_min >= headroom) return "overhead";
  if (!wall.seen_by_laser) return "unseen";
  return wall.stops_robots ? "solid" : "passable";
}

std::vector<std::uint8_t> models_in_view_as_mesh(const World& world) {
  std::vector<std::uint8_t> as_mesh(world.models.size(), 0), fits(world.meshes.size(), 0);
  std::size_t left = kMostViewTriangles;
  for (std::size_t i = 0; i < world.meshes.size(); ++i) {
    const std::size_t triangles = world.meshes[i].corners.size() / 3;
    fits[i] = triangles <= left;
    if (fits[i] != 0) left -= triangles;
  }
  for (const world::MeshModel& row : world.mesh_models) as_mesh[row.model] = fits[row.mesh];
  return as_mesh;
}

base::Bytes solids_message(const World& world, double headroom) {
  const std::vector<std::uint8_t> as_mesh = models_in_view_as_mesh(world);
  const auto walls = wall_groups(world, headroom);
  std::map<std::uint32_t, std::vector<Place>> places;  // by mesh
  for (const world::MeshModel& row : world.mesh_models)
    if (as_mesh[row.model] != 0) places[row.mesh].push_back(place_of(world, row));
  const scene::Mesh roads = scene::roads_of(world);
  const glm::dvec3 origin = view_origin(world);
  const base::Pose X_WO{origin.x, origin.y, origin.z, 0.0};

  base::Bytes out;
  record::CdrWriter cdr(out);
  cdr.put(note_of(world, as_mesh));
  cdr.put_count(walls.size() + places.size() + (roads.faces.empty() ? 0 : 1) + world.terrain.size());
  for (const auto& [group, segments] : walls)
    put_solid(cdr, group.first, scene::mesh_of(segments), origin, {{Place{world::kNone, X_WO, group.second}}});
  for (const auto& [row, of_mesh] : places) put_solid(cdr, "mesh", scene::mesh_of(world.meshes[row]), {}, of_mesh);
  if (!roads.faces.empty()) put_solid(cdr, "road", roads, origin, {{Place{world::kNone, X_WO, kRoadColor}}});
  for (const world::Terrain& terrain : world.terrain)
    put_solid(cdr, "terrain", mesh_of(terrain, step_of(terrain)), {},
              {{Place{world::kNone, world::corner_of(terrain), kTerrainColor}}});
  return out;
}

}  // namespace sf::bridges
