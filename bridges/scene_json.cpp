#include "bridges/scene_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>
#include <utility>

#include "base/rigid_transform.h"
#include "bridges/view_solids.h"
#include "sensors/laneedge_settings.h"
#include "sensors/laser.h"
#include "sensors/laser_modes.h"
#include "world/lights.h"
#include "world/shapes.h"

namespace sf::bridges {

namespace {

using Json = nlohmann::ordered_json;
using world::Segment;
using world::World;

/// Rounds to a tenth of a millimetre: a third of the digits.
double round(double metres) { return std::round(metres * 1e4) / 1e4; }

std::string color_of(std::uint32_t argb) { return fmt::format("#{:06x}", argb & 0xFFFFFFu); }

Json pose_json(const base::Pose& pose) { return {round(pose.x), round(pose.y), std::round(pose.yaw * 1e6) / 1e6}; }

void add_point(Json& line, glm::dvec2 p) {
  line.push_back(round(p.x));
  line.push_back(round(p.y));
}

Json points_json(const std::vector<glm::dvec2>& points) {
  Json line = Json::array();
  for (const glm::dvec2& p : points) add_point(line, p);
  return line;
}

/// Converts segments to lines [x, y, x, y, ...]. Each line continues from segment to segment as far as possible, so
/// that outlines are closed.
Json lines_of(const std::vector<const Segment*>& segments) {
  const auto key = [](glm::dvec2 p) { return std::pair(p.x, p.y); };
  std::multimap<std::pair<double, double>, const Segment*> from;  // not yet in a line, by start point
  for (const Segment* segment : segments) from.emplace(key(segment->a), segment);
  std::set<const Segment*> left(segments.begin(), segments.end());
  Json lines = Json::array();
  for (const Segment* segment : segments) {
    if (left.count(segment) == 0) continue;
    Json line = Json::array();
    add_point(line, segment->a);
    while (segment != nullptr) {
      add_point(line, segment->b);
      left.erase(segment);
      const auto [begin, end] = from.equal_range(key(segment->b));
      const auto next = std::find_if(begin, end, [&](const auto& other) { return left.count(other.second) > 0; });
      segment = next == end ? nullptr : next->second;
    }
    lines.push_back(std::move(line));
  }
  return lines;
}

std::string wall_color(const World& world, std::uint32_t model) {
  const bool known = model < world.models.size() && !world.models[model].is_bitmap;
  return known ? color_of(world.models[model].color) : std::string();
}

Json walls_json(const World& world) {
  std::map<std::tuple<std::string, std::string, bool>, std::vector<const Segment*>> groups;
  const double headroom = headroom_of(world);
  for (const Segment& s : world.walls)
    groups[{wall_kind(s, headroom), wall_color(world, s.model), s.solid_left}].push_back(&s);
  Json walls = Json::array();
  for (const auto& [key, segments] : groups) {
    const auto& [kind, color, closed] = key;
    walls.push_back({{"kind", kind}, {"color", color}, {"closed", closed}, {"lines", lines_of(segments)}});
  }
  return walls;
}

Json markings_json(const World& world) {
  Json markings = Json::array();
  for (const world::LaneMarking& marking : world.lane_markings) {
    markings.push_back(
        {{"line", points_json(marking.line)}, {"width", round(marking.width)}, {"color", color_of(marking.color)}});
    const std::size_t row = markings.size() - 1;
    if (row < world.marking_heights.size()) markings.back()["z"] = round(world.marking_heights[row].z_max);
  }
  return markings;
}

Json lights_json(const World& world) {
  Json lights = Json::array();
  for (const world::Light& light : world.lights) {
    lights.push_back({{"name", light.name}, {"pose", pose_json(light.X_WL)}});
    if (const auto mover = carrier_of(world, light); mover != world::kNone) lights.back()["mover"] = mover;
  }
  return lights;
}

Json emitters_json(const World& world) {
  Json emitters = Json::array();
  for (const world::Emitter& emitter : world.emitters)
    emitters.push_back({{"kind", emitter.kind == world::Emitter::Kind::dock ? "dock" : "virtual wall"},
                        {"pose", pose_json(emitter.X_WE)},
                        {"range", emitter.range},
                        {"fov", emitter.fov},
                        {"halo", emitter.halo}});
  return emitters;
}

Json lamps_json(const World& world) {
  Json lamps = Json::array();
  for (const world::Lamp& lamp : world.lamps) lamps.push_back({round(lamp.X_WL.x), round(lamp.X_WL.y)});
  return lamps;
}

Json magnets_json(const World& world) {
  Json magnets = Json::array();
  for (const world::Magnet& magnet : world.magnets)
    magnets.push_back({round(magnet.p.x), round(magnet.p.y), magnet.moment});
  return magnets;
}

Json holes_json(const World& world) {
  Json holes = Json::array();
  for (const world::FloorHole& hole : world.floor_holes) holes.push_back(points_json(hole.outline));
  return holes;
}

/// The pinhole or fisheye that images a camera's picture (base/lens.h), and its optical frame in the robot's: z along
/// the optical axis, x to the right, y down.
Json camera_json(const record::SensorInfo& sensor, const record::StandardTopic& picture) {
  const base::RigidTransform X =
      base::compose(base::transform_of(sensor.X_MS), base::transform_of(picture.X_SE, picture.tilt));
  const base::Lens& lens = picture.lens;
  return {{"image", picture.topic},
          {"size", {picture.columns, picture.rows}},
          {"focal", {lens.focal.x, lens.focal.y}},
          {"center", {lens.center.x, lens.center.y}},
          {"fisheye", lens.fisheye},
          {"distortion", lens.distortion},
          {"range_max", picture.range_max},
          {"p", {X.p.x, X.p.y, X.p.z}},
          {"axes", {{X.R[0].x, X.R[0].y, X.R[0].z}, {X.R[1].x, X.R[1].y, X.R[1].z}, {X.R[2].x, X.R[2].y, X.R[2].z}}}};
}

/// Adds details that a sensor's messages do not contain: poses of its elements, apertures, the corner of a map.
void add_elements(const record::SensorInfo& sensor, Json& row) {
  using Message = record::StandardTopic::Message;
  for (const record::StandardTopic& element : sensor.standard) {
    if (element.message == Message::range) {
      row["cones"].push_back(pose_json(element.X_SE));
      row["cone_fov"] = element.fov;
      row["range_min"] = element.range_min;
      row["range_max"] = element.range_max;
    } else if (element.message == Message::magnetic_field) {
      row["elements"].push_back(pose_json(element.X_SE));
    } else if (element.message == Message::depth_png || element.message == Message::color_file) {
      row["camera"] = camera_json(sensor, element);  // the colours, if there are any, follow the depths
    } else if (element.message == Message::map) {
      const maps::GridGeometry& grid = element.grid;
      row["map"] = {{"left", grid.left}, {"top", grid.top}, {"cell", grid.cell}, {"words", grid.word_columns}};
    }
  }
}

void add_lane_edge(const sensors::LaneEdge& edge, Json& row) {
  row["fan_fov"] = edge.fan.fov;
  row["range_max"] = edge.fan.range_max;
  row["perpendicular"] = {edge.perpendicular.x, edge.perpendicular.y};
}

Json types_json(const record::RunInfo& info) {
  Json types = Json::object();
  for (const record::SensorTypeInfo& type : info.sensor_types) {
    Json columns = Json::array();
    for (const record::ColumnInfo& column : type.columns)
      columns.push_back({{"name", column.name}, {"width", column.width}});
    types[type.name] = {{"list", type.list}, {"columns", std::move(columns)}, {"scan", type.is_scan}};
  }
  return types;
}

Json sensors_json(const Scene& scene, std::uint32_t mover) {
  const record::RunInfo& info = scene.info;
  const auto edges = scene.sensor_set.settings_of<sensors::LaneEdge>(sensors::kLaneEdge, mover);
  const auto lasers = scene.sensor_set.settings_of<sensors::CastLaser>(sensors::kLaser, mover);
  Json list = Json::array();
  std::uint32_t lane_edges = 0, scans = 0;
  for (const record::SensorInfo& sensor : info.movers[mover].sensors) {
    const record::SensorTypeInfo* const type = record::find_sensor_type(info, sensor.type);
    Json row{{"name", sensor.name},
             {"type", type != nullptr ? type->name : ""},
             {"topic", sensor.topic},
             {"pose", pose_json(sensor.X_MS)},
             {"rate", sensor.rate}};
    if (type != nullptr && type->is_scan) row.update(Json{{"fov", sensor.fov}, {"range_max", sensor.range_max}});
    if (sensor.width > 0) row["columns"] = sensor.width;  // of its type's
    add_elements(sensor, row);
    if (sensor.type == sensors::kLaser && scans < lasers.size()) row["color"] = color_of(lasers[scans++].laser.color);
    if (sensor.type == sensors::kLaneEdge && lane_edges < edges.size()) add_lane_edge(edges[lane_edges++], row);
    list.push_back(std::move(row));
  }
  return list;
}

/// Fleets have few different bodies, so each is stored once in `shapes`; `numbers` maps a body to its number.
/// @param as_mesh per model, for the 3-D view
std::size_t shape_number(const World& world, std::uint32_t row, const std::vector<std::uint8_t>& as_mesh,
                         std::map<std::string, std::size_t>& numbers, Json& shapes) {
  using Heights = std::tuple<double, double, bool>;  // z_min, z_max, whether a mesh is drawn instead
  std::map<bool, std::map<Heights, std::vector<const Segment*>>> parts;
  const world::Mover& mover = world.movers[row];
  for (const Segment& s : mover.body) {
    const bool is_changed = s.model == mover.model && !world::has_own_shape(world, row);
    const bool is_mesh = s.model < as_mesh.size() && as_mesh[s.model] != 0 && !is_changed;
    parts[s.solid_left][{s.z_min, s.z_max, is_mesh}].push_back(&s);
  }
  Json shape;
  for (const bool closed : {true, false}) {
    const std::string name = closed ? "closed" : "open";
    shape[name] = shape[name + "_z"] = Json::array();
    for (const auto& [heights, segments] : parts[closed])
      for (Json& line : lines_of(segments)) {
        shape[name].push_back(std::move(line));
        shape[name + "_z"].push_back(
            {round(std::get<0>(heights)), round(std::get<1>(heights)), std::get<2>(heights) ? 1 : 0});
      }
  }
  const auto [number, is_new] = numbers.try_emplace(shape.dump(), shapes.size());
  if (is_new) shapes.push_back(std::move(shape));
  return number->second;
}

void add_movers(const Scene& scene, Json& json) {
  const World& world = scene.world;
  Json shapes = Json::array(), movers = Json::array();
  std::map<std::string, std::size_t> numbers;
  const std::vector<std::uint8_t> as_mesh = models_in_view_as_mesh(world);
  for (std::uint32_t row = 0; row < world.movers.size(); ++row) {
    const world::Mover& mover = world.movers[row];
    movers.push_back({{"name", mover.name},
                      {"frame", scene.info.movers[row].base_frame},
                      {"space", scene.info.movers[row].space},
                      {"id", mover.id},
                      {"tag", mover.is_tag},
                      {"pose", pose_json(mover.X_WM)},
                      {"radius", round(mover.radius)},
                      {"color", mover.model < world.models.size() ? color_of(world.models[mover.model].color) : ""},
                      {"shape", shape_number(world, row, as_mesh, numbers, shapes)},
                      {"max", {mover.max_forward, mover.max_turn}},
                      {"sensors", sensors_json(scene, row)}});
  }
  json["shapes"] = std::move(shapes);
  json["movers"] = std::move(movers);
}

const char* word_of(ViewerMode mode) {
  if (mode == ViewerMode::run) return "run";
  return mode == ViewerMode::service ? "service" : "recording";
}

}  // namespace

std::string scene_json(const Scene& scene, ViewerMode mode) {
  const World& world = scene.world;
  const world::Extent& e = world.extent;
  Json json{{"world", scene.info.world},
            {"mode", word_of(mode)},
            {"readings", scene.info.record_readings},
            {"interval", scene.info.interval},
            {"extent", {round(e.x_min), round(e.y_min), round(e.x_max), round(e.y_max)}},
            {"types", types_json(scene.info)},
            {"walls", walls_json(world)},
            {"markings", markings_json(world)},
            {"lights", lights_json(world)},
            {"emitters", emitters_json(world)},
            {"lamps", lamps_json(world)},
            {"magnets", magnets_json(world)},
            {"holes", holes_json(world)}};
  add_movers(scene, json);
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace sf::bridges
