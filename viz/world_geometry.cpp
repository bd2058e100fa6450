#include "viz/world_geometry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "base/bearing.h"
#include "base/rigid_transform.h"
#include "scene/solids.h"
#include "viz/signal_layer.h"
#include "world/copies.h"
#include "world/meshes/mesh_file.h"
#include "world/path_geometry.h"
#include "world/shapes.h"
#include "world/terrain.h"

namespace sf::viz {
namespace {

constexpr double kPathStep = 0.05;  // [m]
constexpr double kAbove = 1e-3;     // [m] from a surface to the mark on it

std::int64_t add_point(PolyData& data, const glm::dvec3& p) {
  data.points.push_back(p);
  return static_cast<std::int64_t>(data.points.size()) - 1;
}
std::int64_t add_point(PolyData& data, glm::dvec2 p, double z) { return add_point(data, glm::dvec3(p, z)); }

/// Appends to the array with that name, which is created with its first value.
void append(std::vector<DataArray>& arrays, const char* name, std::initializer_list<double> values) {
  auto found = std::find_if(arrays.begin(), arrays.end(), [&](const DataArray& a) { return a.name == name; });
  if (found == arrays.end()) found = arrays.insert(arrays.end(), {name, static_cast<int>(values.size()), {}});
  found->values.insert(found->values.end(), values);
}

void append_color(std::vector<DataArray>& arrays, std::uint32_t color) {
  const auto part = [&](int shift) { return static_cast<double>((color >> shift) & 0xFFu); };
  append(arrays, "rgb", {part(16), part(8), part(0)});
}

/// Appends a polygon. @param X_WF its frame in the world
void add_polygon(PolyData& data, std::span<const glm::dvec3> corners_F, const base::RigidTransform& X_WF = {}) {
  std::vector<std::int64_t>& polygon = data.polygons.emplace_back();
  for (const glm::dvec3& p : corners_F) polygon.push_back(add_point(data, transform(X_WF, p)));
}

void add_upright(PolyData& data, glm::dvec2 a, glm::dvec2 b, double z_min, double z_max,
                 const base::RigidTransform& X_WF = {}) {
  add_polygon(data, std::array<glm::dvec3, 4>{{{a, z_min}, {b, z_min}, {b, z_max}, {a, z_max}}}, X_WF);
}

constexpr std::uint32_t kTerrainColor = 0xFFA3AD94u;

/// Returns every `step`-th of `points` rows, and the last.
std::vector<std::uint32_t> rows_in_steps(std::uint32_t points, std::uint32_t step) {
  std::vector<std::uint32_t> rows;
  for (std::uint32_t i = 0; i + 1 < points; i += step) rows.push_back(i);
  rows.push_back(points - 1);
  return rows;
}

/// @return the number of triangles
std::size_t add_terrain(PolyData& data, const world::Terrain& terrain) {
  std::uint32_t step = 1;
  while (2 * (std::size_t{terrain.columns} / step + 1) * (std::size_t{terrain.rows} / step + 1) > kMostTerrainTriangles)
    ++step;
  const std::vector<std::uint32_t> columns = rows_in_steps(terrain.columns, step),
                                   rows = rows_in_steps(terrain.rows, step);
  const base::Pose X_WC = world::corner_of(terrain);
  const auto first = static_cast<std::int64_t>(data.points.size()), width = static_cast<std::int64_t>(columns.size());
  for (const std::uint32_t j : rows)
    for (const std::uint32_t i : columns)
      add_point(data, transform(X_WC, glm::dvec2{i * terrain.cell.x, j * terrain.cell.y}),
                X_WC.z + static_cast<double>(terrain.heights[std::size_t{j} * terrain.columns + i]));
  for (std::int64_t j = 0; j + 1 < static_cast<std::int64_t>(rows.size()); ++j)
    for (std::int64_t i = 0; i + 1 < width; ++i) {
      const std::int64_t a = first + j * width + i, above = a + width;
      data.polygons.push_back({a, a + 1, above + 1});
      data.polygons.push_back({a, above + 1, above});
    }
  return 2 * (columns.size() - 1) * (rows.size() - 1);
}

std::uint32_t color_of(const world::World& world, std::uint32_t model) {
  return model < world.models.size() ? world.models[model].color : 0xFF808080u;
}

std::string model_name(const world::World& world, std::uint32_t model) {
  return model < world.models.size() ? world.models[model].name : "";
}

/// The models that are drawn as meshes: all that have one, or none if they are too many.
class DrawnMeshes {
 public:
  explicit DrawnMeshes(const world::World& world) : world_(world), has_(world.models.size(), 0) {
    std::size_t triangles = 0;
    for (const world::MeshModel& row : world.mesh_models) triangles += world.meshes[row.mesh].corners.size() / 3;
    if (triangles > kMostDrawnTriangles) return;
    for (const world::MeshModel& row : world.mesh_models) has_[row.model] = 1;
  }
  /// @param mover kNone: a static model
  bool has(std::uint32_t model, std::uint32_t mover) const {
    return model < has_.size() && has_[model] != 0 &&
           (mover == world::kNone || world_.movers[mover].model != model ||
            world::stretch_of(world_, mover).has_value());
  }
  /// Calls `add_cell(model)` for each triangle of the models of a mover that it has appended.
  template <class AddCell>
  void add(PolyData& data, std::uint32_t mover, const base::RigidTransform& X_WM, const AddCell& add_cell) const {
    const world::CopyIndex copies(world_);
    for (const world::MeshModel& row : world_.mesh_models) {
      const std::uint32_t carrier = world_.models[row.model].mover;
      if (carrier != (mover == world::kNone ? mover : copies.row_of(mover)) || !has(row.model, mover)) continue;
      const world::Mesh& mesh = world_.meshes[row.mesh];
      const auto first = static_cast<std::int64_t>(data.points.size());
      const base::RigidTransform X = compose(X_WM, base::transform_of(row.X_BF));
      const bool is_own = mover != world::kNone && world_.movers[mover].model == row.model;
      const world::Stretch stretch = is_own ? *world::stretch_of(world_, mover) : world::Stretch{};
      for (const glm::dvec3& p : mesh.vertices) add_point(data, transform(X, stretch(p)));
      for (std::size_t i = 0; i + 2 < mesh.corners.size(); i += 3) {
        data.polygons.push_back({first + mesh.corners[i], first + mesh.corners[i + 1], first + mesh.corners[i + 2]});
        add_cell(row.model, mesh);
      }
    }
  }

 private:
  const world::World& world_;
  std::vector<std::uint8_t> has_;  ///< per model
};

/// A convex piece of the top or the bottom of a closed outline.
struct Flat {
  std::vector<glm::dvec3> corners;
  double height = 0.0;  ///< [m] of the outline's sides
  std::uint32_t model = 0;
};

/// @param on_floor leaves out bottoms at z = 0
std::vector<Flat> flats_of(std::span<const world::Segment> segments, bool on_floor) {
  std::map<std::pair<double, double>, std::vector<world::Segment>> outlines;
  for (world::Segment side : segments) {
    side.seen_by_laser = true;  // others are drawn, too
    outlines[{side.z_min, side.z_max}].push_back(side);
  }
  std::vector<Flat> flats;
  for (const auto& [heights, sides] : outlines) {
    const scene::Mesh mesh = scene::mesh_of(sides, on_floor);
    for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
      Flat flat{{}, heights.second - heights.first, mesh.owners[i]};
      for (std::uint32_t k = 0; k < scene::corners_of(mesh.faces[i]); ++k)
        flat.corners.push_back(mesh.vertices[mesh.faces[i][k]]);
      const auto [low, high] = std::ranges::minmax(flat.corners, {}, &glm::dvec3::z);
      if (low.z == high.z) flats.push_back(std::move(flat));
    }
  }
  return flats;
}

void add_line(PolyData& data, const std::vector<glm::dvec2>& points, double width, std::uint32_t color, double kind) {
  std::vector<std::int64_t>& line = data.lines.emplace_back();
  for (const glm::dvec2& p : points) line.push_back(add_point(data, p, 0.0));
  append(data.cell_data, "width", {width});
  append(data.cell_data, "kind", {kind});
  append_color(data.cell_data, color);
}

/// The box on the post of a light, about its axis.
struct Head {
  glm::dvec2 half{};               ///< [m] extents along and across its direction
  double bottom = 0.0, top = 0.0;  ///< [m] above the light's origin
};

Head head_of(const world::World& world, const world::Light& light) {
  Head head;
  for (const world::Segment& wall : world.walls)
    if (wall.model == light.model) head.top = std::max(head.top, wall.z_max - light.X_WL.z);
  head.bottom = head.top;
  for (const world::Segment& wall : world.walls) {
    if (wall.model != light.model || wall.z_max - light.X_WL.z < head.top) continue;
    head.bottom = std::min(head.bottom, wall.z_min - light.X_WL.z);
    const glm::dvec2 p = base::rotate(-light.X_WL.yaw, wall.a - glm::dvec2{light.X_WL.x, light.X_WL.y});
    head.half = max(head.half, abs(p));
  }
  return head;
}

bool flashes(world::LightState state) {
  return state == world::LightState::flashing_red || state == world::LightState::flashing_yellow;
}

/// [m] Returns the heights of the lamp that is lit: of three, red is on top and green below.
std::pair<double, double> lamp_of(const Head& head, bool single, world::LightState state) {
  using enum world::LightState;
  if (single || state == dark) return {head.bottom, head.top};
  const double third = (head.top - head.bottom) / 3.0;
  const double row = state == green ? 0.0 : state == red || state == flashing_red ? 2.0 : 1.0;
  return {head.bottom + row * third, head.bottom + (row + 1.0) * third};
}

}  // namespace

PolyData walls_geometry(const world::World& world) {
  PolyData data;
  const DrawnMeshes meshes(world);
  const auto add_cell = [&](std::uint32_t model, double height, bool laser, bool robots) {
    append(data.cell_data, "model", {static_cast<double>(model)});
    append(data.cell_data, "height", {height});
    append(data.cell_data, "laser", {laser ? 1.0 : 0.0});
    append(data.cell_data, "robots", {robots ? 1.0 : 0.0});
    append_color(data.cell_data, color_of(world, model));
    data.names.push_back(model_name(world, model));
  };
  std::map<std::uint32_t, const world::Segment*> wall_of;  // one per model
  std::vector<world::Segment> drawn;
  for (const world::Segment& wall : world.walls) {
    const world::Segment*& one = wall_of[wall.model];
    if (one == nullptr || wall.stops_robots) one = &wall;
    if (!meshes.has(wall.model, world::kNone)) drawn.push_back(wall);
  }
  for (const world::Segment& wall : drawn) {
    add_upright(data, wall.a, wall.b, wall.z_min, wall.z_max);
    add_cell(wall.model, wall.z_max - wall.z_min, wall.seen_by_laser, wall.stops_robots);
  }
  for (const Flat& flat : flats_of(drawn, true)) {
    const world::Segment& wall = *wall_of.at(flat.model);
    add_polygon(data, flat.corners);
    add_cell(flat.model, flat.height, wall.seen_by_laser, wall.stops_robots);
  }
  const world::Mesh* last = nullptr;
  double height = 0.0;
  meshes.add(data, world::kNone, {}, [&](std::uint32_t model, const world::Mesh& mesh) {
    if (&mesh != last) last = &mesh, height = world::box_of(mesh.vertices).size().z;
    const auto wall = wall_of.find(model);
    add_cell(model, height, true, wall != wall_of.end() && wall->second->stops_robots);
  });
  for (const world::Terrain& terrain : world.terrain) {
    const auto [low, high] = std::ranges::minmax(terrain.heights);
    for (std::size_t left = add_terrain(data, terrain); left > 0; --left) {
      append(data.cell_data, "model", {-1.0});
      append(data.cell_data, "height", {static_cast<double>(high - low)});
      append(data.cell_data, "laser", {1.0});
      append(data.cell_data, "robots", {0.0});
      append_color(data.cell_data, kTerrainColor);
      data.names.push_back("terrain");
    }
  }
  return data;
}

PolyData roads_geometry(const world::World& world) {
  PolyData data;
  for (const world::LaneMarking& marking : world.lane_markings)
    if (marking.line.size() > 1) add_line(data, marking.line, marking.width, marking.color, 0.0);
  for (const world::Path& path : world.paths) {
    const double length = world::length_of(path);
    const int steps = std::max(1, static_cast<int>(std::ceil(length / kPathStep)));
    std::vector<glm::dvec2> points;
    for (int i = 0; i <= steps; ++i) {
      const base::Pose X_WP = world::pose_at(path, length * i / steps);
      points.push_back({X_WP.x, X_WP.y});
    }
    add_line(data, points, path.pieces.empty() ? 0.0 : path.pieces.front().width, 0xFF808080u, 1.0);
  }
  return data;
}

PolyData bodies_geometry(const world::World& world, std::span<const base::TiltedPose> poses) {
  PolyData data;
  const DrawnMeshes meshes(world);
  for (std::uint32_t m = 0; m < std::min(poses.size(), world.movers.size()); ++m) {
    if (base::is_absent(poses[m].X)) continue;
    const base::RigidTransform X_WM = base::transform_of(poses[m].X, poses[m].tilt);
    const auto add_cell = [&](std::uint32_t model) {
      append(data.cell_data, "robot", {static_cast<double>(m)});
      append_color(data.cell_data, color_of(world, model));
      data.names.push_back(world.movers[m].name);
    };
    for (const Flat& flat : flats_of(world.movers[m].body, false)) {
      if (meshes.has(flat.model, m)) continue;
      add_polygon(data, flat.corners, X_WM);
      add_cell(flat.model);
    }
    for (const world::Segment& side : world.movers[m].body) {
      if (meshes.has(side.model, m)) continue;
      add_upright(data, side.a, side.b, side.z_min, side.z_max, X_WM);
      add_cell(side.model);
    }
    meshes.add(data, m, X_WM, [&](std::uint32_t model, const world::Mesh&) { add_cell(model); });
  }
  return data;
}

PolyData lights_geometry(const world::World& world, std::span<const world::LightState> states) {
  PolyData data;
  for (std::size_t i = 0; i < std::min(states.size(), world.lights.size()); ++i) {
    const world::Light& light = world.lights[i];
    const auto add_cell = [&] {
      append(data.cell_data, "light", {static_cast<double>(i)});
      append_color(data.cell_data, signal_legend_item(states[i]).color);
      data.names.push_back(light.name);
    };
    const Head head = head_of(world, light);
    const double size = flashes(states[i]) ? 0.5 : 1.0;
    std::vector<std::int64_t>& indicator = data.polygons.emplace_back();
    for (const glm::dvec2& corner : {glm::dvec2{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
      indicator.push_back(
          add_point(data, transform(light.X_WL, size * corner * head.half), light.X_WL.z + head.top + kAbove));
    add_cell();
    const auto [low, high] = lamp_of(head, light.single, states[i]);
    const double middle = 0.5 * (low + high), half = 0.5 * size * (high - low), front = head.half.x + kAbove;
    add_upright(data, transform(light.X_WL, {front, -size * head.half.y}),
                transform(light.X_WL, {front, size * head.half.y}), light.X_WL.z + middle - half,
                light.X_WL.z + middle + half);
    add_cell();
  }
  return data;
}

PolyData trajectories_geometry(const world::World& world, std::span<const std::vector<MotionSample>> motions) {
  PolyData data;
  for (std::size_t m = 0; m < motions.size(); ++m) {
    bool drawing = false;
    for (const MotionSample& s : motions[m]) {
      if (base::is_absent(s.X_WM)) {
        drawing = false;
        continue;
      }
      if (!drawing) {
        data.lines.emplace_back();
        append(data.cell_data, "robot", {static_cast<double>(m)});
        data.names.push_back(world.movers[m].name);
      }
      drawing = true;
      data.lines.back().push_back(add_point(data, {s.X_WM.x, s.X_WM.y}, s.X_WM.z));
      append(data.point_data, "time", {s.time});
      append(data.point_data, "speed", {s.speed});
      append(data.point_data, "yaw", {s.X_WM.yaw});
      append(data.point_data, "contact", {s.contact ? 1.0 : 0.0});
    }
  }
  return data;
}

void ScanGeometry::add(const sensors::SensorSpec& laser, const base::RigidTransform& X_MS,
                       const base::ReadingBlock& scan) {
  const base::RigidTransform X_WS = compose(base::transform_of(scan.X_WM, scan.tilt), X_MS);
  for (std::size_t i = 0; i < scan.values.size(); ++i) {
    const double bearing = bearing_of(laser, static_cast<std::uint32_t>(i));
    const glm::dvec3 end = transform(X_WS, scan.values[i] * glm::dvec3(base::direction(bearing), 0.0));
    const double hit = i >= scan.hits.size() || scan.hits[i] == base::kNoHit ? -1.0
                       : scan.hits[i] == base::kFloorHit                     ? -2.0
                                                                             : static_cast<double>(scan.hits[i]);
    const bool bounded = i >= scan.quality.size() || scan.quality[i] == base::QualityFlag::none;
    const auto add_sample = [&](const glm::dvec3& p) {
      append(data_.point_data, "range", {scan.values[i]});
      append(data_.point_data, "bearing", {bearing});
      append(data_.point_data, "hit", {hit});
      append(data_.point_data, "bound", {bounded ? scan.bound : HUGE_VAL});
      append(data_.point_data, "robot", {static_cast<double>(scan.mover)});
      append(data_.point_data, "sensor", {static_cast<double>(scan.sensor)});
      append(data_.point_data, "time", {1e-9 * static_cast<double>(scan.time)});
      return add_point(data_, p);
    };
    if (beams_)
      data_.lines.push_back({add_sample(X_WS.p), add_sample(end)});
    else
      data_.dots.push_back({add_sample(end)});
  }
}

}  // namespace sf::viz
