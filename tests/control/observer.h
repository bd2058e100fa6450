#pragma once
// Decisions of one robot at conflict zones, from single observations of robots at chosen places.

#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "control/right_of_way.h"
#include "tests/control/traffic.h"
#include "world/roads/network.h"

namespace sf::traffic {

/// Returns a network of straight lanes 0.5 m wide, by segment, in metres.
/// @param statements of lanes: "stop 1.1.2", "exit 1.1.2 2.1.1"
inline world::RoadNetwork straight_lanes(const std::vector<std::vector<std::vector<glm::dvec2>>>& segments,
                                         const std::vector<std::string>& statements = {}) {
  std::string text = fmt::format("RNDF_name lanes\nnum_segments {}\nnum_zones 0\n", segments.size());
  std::string sidecar = "lane_width_m = 0.5\n";
  for (std::size_t s = 0; s < segments.size(); ++s) {
    text += fmt::format("segment {}\nnum_lanes {}\n", s + 1, segments[s].size());
    for (std::size_t l = 0; l < segments[s].size(); ++l) {
      const auto& points = segments[s][l];
      const std::string lane = fmt::format("{}.{}", s + 1, l + 1);
      std::string rows;
      text += fmt::format("lane {}\nnum_waypoints {}\n", lane, points.size());
      for (const std::string& statement : statements)
        if (statement.compare(5, lane.size() + 1, lane + ".") == 0) text += statement + "\n";
      for (std::size_t i = 0; i < points.size(); ++i) {
        const std::string point = fmt::format("{}.{}", lane, i + 1);
        rows += fmt::format("{} 0 0\n", point);
        sidecar += fmt::format("[points.\"{}\"]\nposition = [{:.17}, {:.17}]\n", point, points[i].x, points[i].y);
      }
      text += rows + "end_lane\n";
    }
    text += "end_segment\n";
  }
  std::vector<world::Warning> warnings;
  return world::build_network(world::parse_rndf("lanes.rndf", text + "end_file\n"),
                              world::parse_sidecar("lanes.toml", sidecar, warnings), warnings);
}

/// A lane of 12 m along +x, and two of 6 m along +y that cross it 4 m and 6.5 m along it.
inline constexpr std::uint32_t kMain = 0, kCross = 1, kFarCross = 2;
inline world::RoadNetwork two_crossings() {
  return straight_lanes({{{{0, 0}, {12, 0}}}, {{{4, -3}, {4, 3}}}, {{{6.5, -3}, {6.5, 3}}}});
}

struct Site {
  explicit Site(const world::RoadNetwork& network, const std::vector<world::Light>& lights = {},
                const control::RoadFootprint& body = {})
      : roads(network), world(with(lights)), corridors(roads, world, body) {}
  static world::World with(const std::vector<world::Light>& lights) {
    world::World world = scenes::empty_world();
    world.lights = lights;
    return world;
  }
  /// Returns the way between two lanes: an exit, or the lane change that leaves at `leave` [m].
  std::uint32_t way(control::Way::Kind kind, const std::string& from, const std::string& into,
                    double leave = NAN) const {
    for (std::uint32_t row = 0; row < corridors.ways().size(); ++row) {
      const control::Way& way = corridors.way(row);
      if (way.kind != kind || way.from == world::kNone || way.into == world::kNone) continue;
      const bool there = std::isnan(leave) || std::abs(way.leave - leave) < 1e-3;
      if (there && lane_name(roads, roads.lanes[way.from]) == from && lane_name(roads, roads.lanes[way.into]) == into)
        return row;
    }
    throw std::runtime_error("no way from " + from + " to " + into);
  }
  std::uint32_t exit(const std::string& from, const std::string& into) const {
    return way(control::Way::Kind::exit, from, into);
  }
  std::uint32_t lane(const std::string& name) const {
    for (std::uint32_t row = 0; row < roads.lanes.size(); ++row)
      if (lane_name(roads, roads.lanes[row]) == name) return row;
    throw std::runtime_error("no lane " + name);
  }
  Pose on(std::uint32_t row, double s) const {
    const glm::dvec2 p = point_on(corridors.way(row), s);
    return {p.x, p.y, 0.0, yaw_on(corridors.way(row), s)};
  }
  /// Returns the pose `ahead` [m] before a waiting line of a lane.
  Pose before(std::uint32_t lane, double ahead, std::size_t line = 0) const {
    return on(lane, corridors.way(lane).lines.at(line) - ahead);
  }
  const control::Conflict& conflict(std::uint32_t row, std::uint32_t other) const {
    for (const control::ConflictZone& zone : corridors.way(row).conflict_zones)
      for (const control::Conflict& conflict : zone.conflicts)
        if (conflict.way == other) return conflict;
    throw std::runtime_error("no conflict");
  }

  world::RoadNetwork roads;
  world::World world;
  control::LaneCorridors corridors;
  std::vector<world::Signal> signals;
};

struct Seen {
  std::uint32_t id;
  Pose X_WM;
  double speed = 0.0;
  std::uint32_t follows = base::kNoId;
};

/// The right of way as robot `id` observes it.
struct Observer {
  Observer(const Site& s, std::uint32_t id) : site(s), rights(s.corridors, id) {}
  void see(double seconds, const Seen& self, const std::vector<Seen>& others = {}, bool merges = false) {
    std::vector<control::Neighbour> neighbours;
    for (const Seen& other : others)
      neighbours.push_back(
          {other.id, {.X_WM = other.X_WM, .velocity = {other.speed, 0, 0}}, {.follows = other.follows}});
    rights.observe({.time = std::llround(1e9 * seconds),
                    .state = {.X_WM = self.X_WM, .velocity = {self.speed, 0, 0}},
                    .readings = {},
                    .others = neighbours,
                    .signals = site.signals},
                   self.follows, merges);
  }
  const control::RoadUser& user(std::size_t row = 0) const { return rights.road_users().at(row); }
  const control::Approach& approach() const { return user().approach; }
  /// Returns whether it may drive on along a way, considering only the conflict with another way.
  bool may_enter(std::uint32_t row, std::uint32_t other) const {
    const control::Conflict& conflict = site.conflict(row, other);
    return rights.may_enter(row, {.hold = 0.0, .end = 0.0, .conflicts = {conflict}});
  }

  const Site& site;
  control::RightOfWay rights;
};

}  // namespace sf::traffic
