#include "control/route_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <queue>

#include "base/elementary.h"
#include "base/error.h"
#include "base/random.h"

namespace sf::control {

namespace {

using world::PointRef;

void append(RoutePlan& plan, std::uint32_t way, double from, double to) {
  if (!plan.legs.empty()) {
    RouteLeg& last = plan.legs.back();
    if (last.way == way && last.to == from) {
      last.to = to;
      return;
    }
  }
  plan.legs.push_back({way, from, to, plan.legs.empty() ? 0.0 : end_of(plan.legs.back())});
}

void append(const LaneCorridors& corridors, RoutePlan& plan, const Edge& edge) {
  const bool lane = corridors.way(edge.ways[0]).kind == Way::Kind::lane;
  append(plan, edge.ways[0], edge.from_s, lane ? edge.to_s : corridors.way(edge.ways[0]).length);
  if (edge.ways[1] != world::kNone) append(plan, edge.ways[1], 0.0, corridors.way(edge.ways[1]).length);
  plan.node = edge.to;
}

/// Returns the edges of the shortest path, at least one; empty if there is none.
std::vector<Edge> shortest(const LaneCorridors& corridors, std::uint32_t from, std::uint32_t to, std::uint32_t avoid) {
  const std::size_t count = corridors.roads().index.size();
  struct Reached {
    double cost = HUGE_VAL;
    std::uint32_t before = world::kNone;
    std::uint32_t edge = 0;
  };
  std::vector<Reached> reached(count);
  using Open = std::pair<double, std::uint32_t>;
  std::priority_queue<Open, std::vector<Open>, std::greater<>> open;
  const auto relax = [&](std::uint32_t node, double cost) {
    const auto& edges = corridors.edges(node);
    for (std::uint32_t i = 0; i < edges.size(); ++i) {
      if (edges[i].ways[0] == avoid) continue;
      Reached& next = reached[edges[i].to];
      const double reach = cost + edges[i].cost;
      if (reach >= next.cost) continue;
      next = {reach, node, i};
      open.push({reach, edges[i].to});
    }
  };
  relax(from, 0.0);
  while (!open.empty()) {
    const auto [cost, node] = open.top();
    open.pop();
    if (cost > reached[node].cost) continue;
    if (node == to) break;
    relax(node, cost);
  }
  std::vector<Edge> edges;
  if (reached[to].before == world::kNone) return edges;
  std::uint32_t node = to;
  do {
    const Reached& r = reached[node];
    edges.push_back(corridors.edges(r.before)[r.edge]);
    node = r.before;
  } while (node != from);
  std::reverse(edges.begin(), edges.end());
  return edges;
}

/// Returns the point of a lane where another way enters it.
std::uint32_t entry_of(const LaneCorridors& corridors, const Way& way) {
  return corridors.node_of({PointRef::Kind::lane, way.into, point_from(corridors.roads().lanes[way.into], way.enter)});
}

/// Returns the row of the same line, driven in the same way.
std::optional<std::uint32_t> same_way(const LaneCorridors& from, const LaneCorridors& to, std::uint32_t row) {
  const Way& way = from.way(row);
  const auto is_same = [&](const Way& other) {
    return other.kind == way.kind && other.from == way.from && other.into == way.into &&
           other.backwards == way.backwards && other.length == way.length &&
           other.points.front() == way.points.front() && other.points.back() == way.points.back();
  };
  if (row < to.ways().size() && is_same(to.way(row))) return row;
  const auto found = std::ranges::find_if(to.ways(), is_same);
  if (found == to.ways().end()) return std::nullopt;
  return static_cast<std::uint32_t>(found - to.ways().begin());
}

}  // namespace

std::uint32_t point_from(const world::RoadLane& lane, double s) {
  std::uint32_t i = 0;
  while (i + 1 < lane.points.size() && lane.points[i].s < s) ++i;
  return i;
}

std::size_t leg_at(const RoutePlan& plan, double s) {
  const auto next = std::upper_bound(plan.legs.begin(), plan.legs.end(), s,
                                     [](double at, const RouteLeg& leg) { return at < leg.start; });
  return next == plan.legs.begin() ? 0 : static_cast<std::size_t>(next - plan.legs.begin()) - 1;
}

std::optional<RoadPosition> locate_on_lane(const LaneCorridors& corridors, const Pose& X_WM) {
  for (const RoadPosition& place : corridors.positions(X_WM, corridors.clearance()))
    if (corridors.way(place.way).kind == Way::Kind::lane) return place;
  return std::nullopt;
}

std::optional<RoadPosition> locate_on_road(const LaneCorridors& corridors, const Pose& X_WM) {
  if (const auto lane = locate_on_lane(corridors, X_WM)) return lane;
  for (const RoadPosition& place : corridors.positions(X_WM, corridors.clearance()))
    if (corridors.way(place.way).into != world::kNone) return place;
  return std::nullopt;
}

std::optional<std::uint32_t> spot_at(const LaneCorridors& corridors, const Pose& X_WM) {
  for (std::uint32_t spot = 0; spot < corridors.roads().spots.size(); ++spot) {
    const Pose at = corridors.parked(spot);
    if (base::hypot(at.x - X_WM.x, at.y - X_WM.y) < 0.5 * corridors.body().radius) return spot;
  }
  return std::nullopt;
}

RoutePlan plan_from(const LaneCorridors& corridors, const RoadPosition& place) {
  RoutePlan plan;
  const Way& way = corridors.way(place.way);
  if (way.kind != Way::Kind::lane) {
    append(plan, place.way, std::clamp(place.s, 0.0, way.length), way.length);
    plan.node = entry_of(corridors, way);
    return plan;
  }
  const world::RoadLane& lane = corridors.roads().lanes[place.way];
  const std::uint32_t next = point_from(lane, place.s);
  append(plan, place.way, std::min(place.s, lane.points[next].s), lane.points[next].s);
  plan.node = corridors.node_of({PointRef::Kind::lane, place.way, next});
  return plan;
}

RoutePlan plan_from_spot(const LaneCorridors& corridors, std::uint32_t spot) {
  // The first leg has no length: it is the end of the way into the spot.
  const Edge& in = corridors.edges(corridors.node_of({PointRef::Kind::spot, spot, 0})).front();
  RoutePlan plan;
  const double end = corridors.way(in.ways[0]).length;
  append(plan, in.ways[0], end, end);
  plan.node = in.to;
  return plan;
}

bool extend(const LaneCorridors& corridors, RoutePlan& plan, PointRef to, std::uint32_t avoid) {
  const std::uint32_t node = corridors.node_of(to);
  const auto edges = shortest(corridors, plan.node, node, avoid);
  for (const Edge& edge : edges) append(corridors, plan, edge);
  return !edges.empty();
}

bool extend(const LaneCorridors& corridors, RoutePlan& plan, const world::RoadCheckpoint& to, std::uint32_t avoid) {
  // A checkpoint anywhere in a spot is reached at the spot's end.
  PointRef at = to.at;
  const bool spot = at.kind == PointRef::Kind::spot;
  if (spot) at.index = 1;
  const std::uint32_t node = corridors.node_of(at);
  const bool here = plan.node == node && plan.goals.empty();
  if (!here && !extend(corridors, plan, at, avoid)) return false;
  plan.goals.push_back({to.id, length_of(plan), spot});
  return true;
}

void cut_after(const LaneCorridors& corridors, RoutePlan& plan, double s) {
  std::erase_if(plan.goals, [&](const Goal& goal) { return goal.s > s; });
  const auto ends_on_lane = [&](const RouteLeg& leg) {
    const Way& way = corridors.way(leg.way);
    return way.kind == Way::Kind::lane || way.into != world::kNone;
  };
  const auto at =
      std::find_if(plan.legs.begin() + static_cast<std::ptrdiff_t>(leg_at(plan, s)), plan.legs.end(), ends_on_lane);
  if (at == plan.legs.end()) return;
  plan.legs.erase(at + 1, plan.legs.end());
  RouteLeg& leg = plan.legs.back();
  const Way& way = corridors.way(leg.way);
  if (way.kind == Way::Kind::lane) {
    const world::RoadLane& lane = corridors.roads().lanes[leg.way];
    const std::uint32_t next = point_from(lane, leg.from + std::max(s - leg.start, 0.0));
    leg.to = std::max(lane.points[next].s, leg.from);
    plan.node = corridors.node_of({PointRef::Kind::lane, leg.way, next});
    return;
  }
  leg.to = way.length;
  plan.node = entry_of(corridors, way);
}

std::optional<std::size_t> moved_to(const LaneCorridors& from, const LaneCorridors& to, RoutePlan& plan,
                                    std::size_t leg) {
  std::size_t first = plan.legs.size(), end = plan.legs.size();  // legs that remain
  for (std::size_t i = leg + 1; i-- > 0;) {
    const auto row = same_way(from, to, plan.legs[i].way);
    if (!row) break;
    plan.legs[first = i].way = *row;
  }
  if (first > leg) return std::nullopt;
  for (std::size_t i = leg + 1; i < end; ++i) {
    const auto row = same_way(from, to, plan.legs[i].way);
    row ? plan.legs[i].way = *row : end = i;
  }
  const bool whole = end == plan.legs.size();
  plan.legs.resize(end);
  plan.legs.erase(plan.legs.begin(), plan.legs.begin() + static_cast<std::ptrdiff_t>(first));
  if (!whole) cut_after(to, plan, length_of(plan));
  return first;
}

std::vector<Pose> start_poses(const world::RoadNetwork& roads, std::size_t count, std::uint64_t seed, double apart) {
  std::vector<Pose> open;
  for (const world::RoadLane& lane : roads.lanes) {
    const double length = length_of(lane);
    const double end = 0.5 * apart;
    if (lane.centre.points.size() < 2 || length < 2.0 * end) continue;
    for (double s = end; s <= length - end; s += 0.25 * apart) {
      const glm::dvec2 p = point_at(lane.centre, s);
      const glm::dvec2 d = point_at(lane.centre, s + 0.05 * apart) - point_at(lane.centre, s - 0.05 * apart);
      open.push_back({p.x, p.y, height_at(lane, s), base::atan2(d.y, d.x)});
    }
  }
  std::vector<Pose> poses;
  for (std::uint64_t draw = 0; poses.size() < count && !open.empty(); ++draw) {
    const double u = base::random_uniform(
        {.seed = seed, .stream = base::RandomStream::placement, .b = 0x726F6164u, .c = draw}, 0)[0];
    const auto at = static_cast<std::size_t>(u * static_cast<double>(open.size()));
    const Pose pose = open[std::min(at, open.size() - 1)];
    poses.push_back(pose);
    std::erase_if(open, [&](const Pose& o) { return base::hypot(o.x - pose.x, o.y - pose.y) < apart; });
  }
  if (poses.size() < count)
    throw base::InputError(
        roads.file, 0,
        fmt::format("{} robots {:g} m apart do not fit on its lanes, only {}; use fewer", count, apart, poses.size()));
  return poses;
}

}  // namespace sf::control
