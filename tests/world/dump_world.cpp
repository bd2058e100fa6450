#include "tests/world/dump_world.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <type_traits>

#include "tests/world/successors.h"
#include "world/fields.h"

namespace sf::world {

namespace {

template <class T>
std::string shown(const T& value);

/// Without the folder that this checkout is in.
std::string file_name(const std::string& file) { return std::filesystem::path(file).filename().string(); }

std::string number(double value) {
  if (!std::isfinite(value)) return fmt::format("{}", value);
  return fmt::format("{}", std::round(value * 1e6) / 1e6 + 0.0);
}

template <class Row>
std::string row(const Row& r) {
  std::string text;
  for_each_field<Row>([&](const auto& f) {
    const auto& value = r.*f.member;
    if constexpr (std::is_same_v<decltype(value), const std::string&>)
      text += (text.empty() ? "" : " ") + (f.role == Role::path ? file_name(value) : '"' + value + '"');
    else
      text += (text.empty() ? "" : " ") + shown(value);
  });
  return "(" + text + ")";
}

template <class T>
std::string shown(const T& value) {
  if constexpr (std::is_same_v<T, bool>)
    return value ? "yes" : "no";
  else if constexpr (std::is_enum_v<T>)
    return std::string(words_of(T{})[static_cast<std::size_t>(value)]);
  else if constexpr (std::is_integral_v<T>)
    return value == static_cast<T>(kNone) ? "-" : fmt::format("{}", value);
  else if constexpr (std::is_floating_point_v<T>)
    return number(value);
  else if constexpr (std::is_same_v<T, std::string>)
    return '"' + value + '"';
  else if constexpr (requires { value.begin(); }) {
    std::string text;
    for (const auto& element : value) text += (text.empty() ? "" : " ") + shown(element);
    return "[" + text + "]";
  } else
    return row(value);
}

template <class Rows>
std::string table(const char* name, const Rows& rows) {
  std::string text;
  for (const auto& r : rows) text += fmt::format("{} {}\n", name, shown(r));
  return text;
}

/// The mover's fields except those of its body, sensors and magnets, which have separate lines.
std::string mover_lines(Mover m) {
  const Mover whole = m;
  m.body.clear(), m.sensors.clear(), m.magnets.clear();
  return fmt::format("mover {} tag at {} ctrl '{}'\n", row(m), row(m.X_MT), m.controller) +
         table("  body", whole.body) + table("  sensor", whole.sensors) + table("  magnet", whole.magnets);
}

std::string curve_line(const char* name, const std::vector<glm::dvec2>& line) {
  return fmt::format("  {} {}\n", name, shown(line));
}

std::string id(const RoadNetwork& roads, PointRef at) { return point_id_text(id_of(roads, at)); }

std::string ways_from(const RoadNetwork& roads, PointRef at) {
  constexpr const char* kKinds[] = {"lane", "exit", "zone", "change"};
  std::string text = fmt::format("from {}", id(roads, at));
  if (const auto yaw = yaw_of(roads, at)) text += " yaw " + number(*yaw);
  for (const auto& ways : {successors(roads, at), lane_changes(roads, at)})
    for (const Transition& t : ways)
      text += fmt::format(" {} {} {}", kKinds[static_cast<int>(t.kind)], id(roads, t.to), number(t.length));
  return text + "\n";
}

std::string lane_lines(const RoadNetwork& roads, const RoadLane& lane) {
  std::string text =
      fmt::format("lane {} segment {} width {} {} {} length {}\n", sf::world::lane_name(roads, lane), lane.segment,
                  number(lane.width), word_of(lane.left), word_of(lane.right), number(length_of(lane)));
  for (const LanePoint& p : lane.points)
    text += fmt::format("  {} {} s {} yaw {}\n", point_id_text(p.id), row(p.p), number(p.s), number(p.yaw));
  return text + curve_line("centre", lane.centre.points) + curve_line("tangents", lane.centre.tangents) +
         fmt::format("  s {} knots {}\n", shown(lane.centre.s), shown(lane.centre.knots)) +
         curve_line("left", lane.left_edge) + curve_line("right", lane.right_edge);
}

std::string zone_lines(const RoadNetwork& roads) {
  std::string text;
  for (const RoadZone& z : roads.zones) {
    text += fmt::format("zone {} '{}' spots {} from {}\n", z.id, z.name, z.spots, z.first_spot);
    for (const PerimeterPoint& p : z.perimeter) text += fmt::format("  {} {}\n", point_id_text(p.id), row(p.p));
  }
  for (const RoadSpot& s : roads.spots)
    text += fmt::format("spot {} of {} width {} {} {}\n", s.number, s.zone, number(s.width), row(s.entry), row(s.end));
  return text;
}

std::string joint_lines(const RoadNetwork& roads) {
  std::string text;
  for (const RoadExit& e : roads.exits)
    text += fmt::format("exit {} {} length {}\n", id(roads, e.from), id(roads, e.to), number(e.length)) +
            curve_line("curve", exit_curve(roads, e).points);
  for (const StopLine& s : roads.stops)
    text += fmt::format("stop {} {} {}\n", id(roads, s.at), row(s.left), row(s.right));
  for (const RoadCheckpoint& c : roads.checkpoints)
    text += fmt::format("checkpoint {} {} {}\n", c.id, id(roads, c.at), row(c.p));
  for (const auto& [point, at] : roads.index) {
    text += ways_from(roads, at);
    for (const Transition& t : lane_changes(roads, at))
      text += curve_line("change", lane_change_curve(roads, at, t.to).points);
  }
  return text;
}

}  // namespace

std::string dump_of(const World& world) {
  World rest = world;  // only the fields of the world itself
  rest.models.clear(), rest.walls.clear(), rest.lane_markings.clear(), rest.magnets.clear(), rest.movers.clear();
  rest.paths.clear(), rest.lights.clear(), rest.emitters.clear(), rest.lamps.clear(), rest.heat_sources.clear();
  rest.fiducials.clear();
  rest.floor_holes.clear();
  rest.warnings.clear();
  rest.hash = 0, rest.road_files.clear(), rest.unmodelled.clear();
  std::string text = fmt::format("world {}\n", row(rest));
  for (const std::string& file : world.road_files) text += "roads " + file_name(file) + "\n";
  for (const auto& [type, count] : world.unmodelled) text += fmt::format("unmodelled {} {}\n", type, count);
  const Extent& e = world.extent;
  text += fmt::format("extent {} {} {} {}\n", number(e.x_min), number(e.y_min), number(e.x_max), number(e.y_max));
  for (const Model& m : world.models) text += fmt::format("model {} color {:08x}\n", row(m), m.color);
  text += table("wall", world.walls) + table("marking", world.lane_markings) + table("magnet", world.magnets);
  for (const Mover& m : world.movers) text += mover_lines(m);
  return text + table("path", world.paths) + table("light", world.lights) + table("emitter", world.emitters) +
         table("lamp", world.lamps) + table("heat", world.heat_sources) + table("fiducial", world.fiducials) +
         table("hole", world.floor_holes) + table("warning", world.warnings);
}

std::string dump_of(const RoadNetwork& roads) {
  const RoadCounts& n = roads.counts;
  const MarkingSizes& p = roads.paint;
  const Extent& e = roads.extent;
  std::string text = fmt::format("network '{}' {} scale {} tolerance {}\n", roads.name, file_name(roads.file),
                                 number(roads.scale), number(roads.tolerance));
  text += fmt::format("counts {} {} {} {} {} {} {} {} {}\n", n.segments, n.lanes, n.zones, n.spots, n.lane_waypoints,
                      n.points, n.exits, n.stops, n.checkpoints);
  text += fmt::format("paint {} {} {} {} extent {} {} {} {}\n", number(p.line_width), number(p.dash_length),
                      number(p.dash_gap), number(p.stop_width), number(e.x_min), number(e.y_min), number(e.x_max),
                      number(e.y_max));
  for (const RoadSegment& s : roads.segments)
    text += fmt::format("segment {} '{}' lanes {} from {}\n", s.id, s.name, s.lanes, s.first_lane);
  for (const RoadLane& lane : roads.lanes) text += lane_lines(roads, lane);
  return text + zone_lines(roads) + joint_lines(roads);
}

std::string dump_of(const LightPlan& plan) {
  std::string text = "plan of " + file_name(plan.world) + "\n";
  for (const LightProgram& p : plan.programs) {
    text += fmt::format("program '{}' lights {} offset {} actuated {}\n", p.name, shown(p.lights), number(p.offset),
                        is_actuated(p));
    for (const LightStage& s : p.stages)
      text += fmt::format("  stage {} {} to {} gap {} detectors {} on call {} yellow {} clear {}\n", shown(s.states),
                          number(s.shortest), number(s.longest), number(s.gap), shown(s.detectors), s.on_call,
                          number(s.yellow), number(s.clear));
  }
  for (const LightDetector& d : plan.detectors) {
    text += fmt::format("detector '{}' {} radius {}", d.name, d.p ? row(*d.p) : "-", number(d.radius));
    for (const auto& [from, to] : d.calls) text += fmt::format(" {}..{}", number(from), number(to));
    text += "\n";
  }
  return text;
}

}  // namespace sf::world
