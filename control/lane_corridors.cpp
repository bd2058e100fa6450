#include "control/lane_corridors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "base/elementary.h"
#include "base/error.h"
#include "robots/footprint.h"

namespace sf::control {

namespace {

using world::PointRef;

constexpr double kChangeCost = 1.0;  // [m] added to the length, so that routes change lanes only if that helps

/// Samples a line evenly.
void sample(Way& way, const world::Curve& line, double step) {
  way.length = std::max(line.s.back(), 1e-6);
  const auto spans = static_cast<std::size_t>(std::max(1.0, std::ceil(way.length / step)));
  way.step = way.length / static_cast<double>(spans);
  for (std::size_t i = 0; i <= spans; ++i) way.points.push_back(point_at(line, static_cast<double>(i) * way.step));
  way.yaw.resize(spans + 1);
  const auto direction = [](glm::dvec2 d) { return base::atan2(d.y, d.x); };
  for (std::size_t i = 0; i <= spans; ++i) {
    double yaw = i == 0       ? direction(line.tangents.front())
                 : i == spans ? direction(line.tangents.back())
                              : direction(way.points[i + 1] - way.points[i - 1]);
    if (i > 0) yaw = way.yaw[i - 1] + base::wrap_angle(yaw - way.yaw[i - 1]);
    way.yaw[i] = yaw;
  }
  for (const double yaw : way.yaw) way.tangents.push_back(base::direction(yaw));
  way.curvature.resize(spans + 1);
  for (std::size_t i = 0; i <= spans; ++i) {
    const std::size_t a = i > 0 ? i - 1 : 0, b = std::min(i + 1, spans);
    way.curvature[i] = (way.yaw[b] - way.yaw[a]) / (static_cast<double>(b - a) * way.step);
  }
}

template <class T>
T between(const std::vector<T>& values, const Way& way, double s) {
  const double at = std::clamp(s / way.step, 0.0, static_cast<double>(values.size() - 1));
  const auto i = std::min(static_cast<std::size_t>(at), values.size() - 2);
  return values[i] + (at - static_cast<double>(i)) * (values[i + 1] - values[i]);
}

}  // namespace

RoadFootprint footprint_of(const world::Mover& mover) {
  const robots::Footprint outline = robots::footprint_of(mover);
  double front = 0.0;
  for (const robots::FootprintEdge& edge : outline.edges) front = std::max({front, edge.a.x, edge.b.x});
  return outline.edges.empty() ? RoadFootprint{} : RoadFootprint{outline.radius, front, outline.z_max - outline.z_min};
}

glm::dvec2 point_on(const Way& way, double s) { return between(way.points, way, s); }
double height_on(const Way& way, double s) { return way.z.empty() ? 0.0 : between(way.z, way, s); }
double yaw_on(const Way& way, double s) { return between(way.yaw, way, s); }
double curvature_on(const Way& way, double s) { return between(way.curvature, way, s); }

LaneCorridors::LaneCorridors(const world::RoadNetwork& roads, const world::World& world, const RoadFootprint& body)
    : roads_(roads),
      body_(body),
      clearance_(2.0 * body.radius + 0.25 * body.radius),
      step_(0.25 * body.radius),
      edges_(roads.index.size()) {
  add_lanes(world);
  add_exits();
  add_changes();
  add_zones();
  fill_grid();
  find_conflicts();
  make_lines();
}

std::uint32_t LaneCorridors::node_of(PointRef at) const {
  const world::PointId id = id_of(roads_, at);
  const auto found = std::lower_bound(roads_.index.begin(), roads_.index.end(), id,
                                      [](const auto& row, world::PointId wanted) { return row.first < wanted; });
  SF_CHECK(found != roads_.index.end() && found->first == id, "no point " + world::point_id_text(id));
  return static_cast<std::uint32_t>(found - roads_.index.begin());
}

/// @param from_z, to_z [m] heights of its ends; the height is linear between them
std::uint32_t LaneCorridors::add_way(Way way, const world::Curve& line, double from_z, double to_z) {
  points_ += line.s.back() / step_ + 2.0;
  if (!(points_ <= kMaxWayPoints))
    throw base::InputError(
        fmt::format("a robot of radius {:g} m is too small for these roads: their lines have a point every quarter of "
                    "the radius, and at most {:g} points in all; expected a larger body",
                    body_.radius, kMaxWayPoints));
  sample(way, line, step_);
  for (std::size_t i = 0; (from_z != 0.0 || to_z != 0.0) && i < way.points.size(); ++i)
    way.z.push_back(from_z + static_cast<double>(i) * way.step / way.length * (to_z - from_z));
  ways_.push_back(std::move(way));
  return static_cast<std::uint32_t>(ways_.size() - 1);
}

void LaneCorridors::add_edge(PointRef from, PointRef to, std::uint32_t way, double from_s, double to_s, double extra) {
  edges_[node_of(from)].push_back({node_of(to), {way, world::kNone}, from_s, to_s, to_s - from_s + extra});
}

/// Sets the heights of a lane's way.
void LaneCorridors::raise(Way& way, const world::RoadLane& lane) {
  if (std::ranges::all_of(lane.points, [](const world::LanePoint& point) { return point.z == 0.0; })) return;
  raised_ = true;
  for (std::size_t i = 0; i < way.points.size(); ++i)
    way.z.push_back(world::height_at(lane, static_cast<double>(i) * way.step));
}

void LaneCorridors::add_lanes(const world::World& world) {
  for (std::uint32_t row = 0; row < roads_.lanes.size(); ++row) {
    const world::RoadLane& lane = roads_.lanes[row];
    raise(ways_[add_way({.kind = Way::Kind::lane}, lane.centre)], lane);
    for (std::uint32_t i = 0; i + 1 < lane.points.size(); ++i)
      add_edge({PointRef::Kind::lane, row, i}, {PointRef::Kind::lane, row, i + 1}, row, lane.points[i].s,
               lane.points[i + 1].s, 0.0);
  }
  for (const world::StopLine& stop : roads_.stops) {
    LaneStop mark{roads_.lanes[stop.at.row].points[stop.at.index].s, {}};
    const std::string name = point_id_text(stop.lights);
    for (std::uint32_t light = 0; light < world.lights.size(); ++light) {
      const auto& points = world.lights[light].points;
      if (std::find(points.begin(), points.end(), name) != points.end()) mark.lights.push_back(light);
    }
    ways_[stop.at.row].stops.push_back(std::move(mark));
  }
  for (Way& way : ways_)
    std::sort(way.stops.begin(), way.stops.end(), [](const auto& a, const auto& b) { return a.s < b.s; });
}

void LaneCorridors::add_exits() {
  for (const world::RoadExit& exit : roads_.exits) {
    Way way{.kind = Way::Kind::exit};
    if (exit.from.kind == PointRef::Kind::lane) {
      const world::RoadLane& lane = roads_.lanes[exit.from.row];
      way.from = exit.from.row;
      way.leave = lane.points[exit.from.index].s;
      way.at_end = exit.from.index + 1 == lane.points.size();
    } else {
      way.in_zone = true;
      way.zone = exit.from.row;
    }
    if (exit.to.kind == PointRef::Kind::lane) {
      way.into = exit.to.row;
      way.enter = roads_.lanes[exit.to.row].points[exit.to.index].s;
    } else {
      way.in_zone = true;
      way.zone = exit.to.row;
    }
    const std::uint32_t row =
        add_way(way, exit_curve(roads_, exit), height_of(roads_, exit.from), height_of(roads_, exit.to));
    if (exit.open) add_edge(exit.from, exit.to, row, 0.0, ways_[row].length, 0.0);
  }
}

void LaneCorridors::add_changes() {
  for (std::uint32_t row = 0; row < roads_.lanes.size(); ++row) {
    for (std::uint32_t i = 0; i < roads_.lanes[row].points.size(); ++i) {
      const PointRef from{PointRef::Kind::lane, row, i};
      for (const world::Transition& step : lane_changes(roads_, from)) {
        Way way{.kind = Way::Kind::change, .from = row, .into = step.to.row};
        way.leave = roads_.lanes[row].points[i].s;
        way.enter = roads_.lanes[step.to.row].points[step.to.index].s;
        const std::uint32_t added =
            add_way(way, lane_change_curve(roads_, from, step.to), height_of(roads_, from), height_of(roads_, step.to));
        if (roads_.lanes[step.to.row].open) add_edge(from, step.to, added, 0.0, ways_[added].length, kChangeCost);
      }
    }
  }
}

std::shared_ptr<const LaneCorridors> shared_lane_corridors(const world::RoadNetwork& roads, const world::World& world,
                                                           const RoadFootprint& body) {
  // Corridors refer to their network, so its address identifies the network as long as they exist.
  struct Shared {
    const world::World* world;
    RoadFootprint body;
    std::weak_ptr<const LaneCorridors> corridors;
  };
  static std::mutex mutex;
  static std::vector<Shared> all;
  const std::lock_guard lock(mutex);
  std::erase_if(all, [](const Shared& shared) { return shared.corridors.expired(); });
  for (const Shared& shared : all) {
    const auto corridors = shared.corridors.lock();
    if (corridors && &corridors->roads() == &roads && shared.world == &world && shared.body == body) return corridors;
  }
  auto corridors = std::make_shared<const LaneCorridors>(roads, world, body);
  all.push_back({&world, body, corridors});
  return corridors;
}

}  // namespace sf::control
