#include "world/roads/network.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/elementary.h"

namespace sf::world {

std::optional<PointRef> find_point(const RoadNetwork& network, PointId id) {
  const auto found = std::lower_bound(network.index.begin(), network.index.end(), id,
                                      [](const auto& row, PointId wanted) { return row.first < wanted; });
  if (found == network.index.end() || found->first != id) return std::nullopt;
  return found->second;
}

const RoadCheckpoint* find_checkpoint(const RoadNetwork& network, int id) {
  const auto found = std::lower_bound(network.checkpoints.begin(), network.checkpoints.end(), id,
                                      [](const RoadCheckpoint& row, int wanted) { return row.id < wanted; });
  return found == network.checkpoints.end() || found->id != id ? nullptr : &*found;
}

PointId id_of(const RoadNetwork& network, PointRef at) {
  if (at.kind == PointRef::Kind::lane) return network.lanes[at.row].points[at.index].id;
  if (at.kind == PointRef::Kind::perimeter) return network.zones[at.row].perimeter[at.index].id;
  const RoadSpot& spot = network.spots[at.row];
  return {static_cast<std::uint16_t>(network.zones[spot.zone].id), static_cast<std::uint16_t>(spot.number),
          static_cast<std::uint16_t>(at.index + 1)};
}

glm::dvec2 position_of(const RoadNetwork& network, PointRef at) {
  if (at.kind == PointRef::Kind::lane) return network.lanes[at.row].points[at.index].p;
  if (at.kind == PointRef::Kind::perimeter) return network.zones[at.row].perimeter[at.index].p;
  return at.index == 0 ? network.spots[at.row].entry : network.spots[at.row].end;
}

std::optional<double> yaw_of(const RoadNetwork& network, PointRef at) {
  if (at.kind == PointRef::Kind::perimeter) return std::nullopt;
  if (at.kind == PointRef::Kind::spot) {
    const glm::dvec2 along = network.spots[at.row].end - network.spots[at.row].entry;
    return base::atan2(along.y, along.x);
  }
  const RoadLane& lane = network.lanes[at.row];
  if (lane.centre.points.size() < 2) return std::nullopt;
  return lane.points[at.index].yaw;
}

std::string lane_name(const RoadNetwork& network, const RoadLane& lane) {
  return fmt::format("{}.{}", network.segments[lane.segment].id, lane.number);
}

Curve exit_curve(const RoadNetwork& network, const RoadExit& exit) {
  const glm::dvec2 a = position_of(network, exit.from);
  const glm::dvec2 b = position_of(network, exit.to);
  const double d = length(b - a);
  const glm::dvec2 straight = d > 0.0 ? (1.0 / d) * (b - a) : glm::dvec2{1.0, 0.0};
  const auto direction = [&](PointRef at) {
    const auto yaw = yaw_of(network, at);
    return yaw ? base::direction(*yaw) : straight;
  };
  return connection(a, direction(exit.from), b, direction(exit.to), {network.tolerance, 0.0, 4096});
}

namespace {

constexpr double kWidths = 3.0;  // [lane widths] smallest advance along the lane during a change

struct Beside {
  double s = 0.0;  ///< [m] along the other lane
  glm::dvec2 p;
  glm::dvec2 tangent;
};

/// Returns the point of a lane's centre line nearest to `p`. The lane has at least two points.
Beside nearest_of(const RoadLane& lane, glm::dvec2 p) {
  const Curve& c = lane.centre;
  Beside best;
  double least = HUGE_VAL;
  for (std::size_t i = 0; i + 1 < c.points.size(); ++i) {
    const glm::dvec2 d = c.points[i + 1] - c.points[i];
    const double t = std::clamp(dot(p - c.points[i], d) / dot(d, d), 0.0, 1.0);
    const glm::dvec2 q = c.points[i] + t * d;
    const double distance = length(p - q);
    if (distance >= least) continue;
    least = distance;
    best = {c.s[i] + t * (c.s[i + 1] - c.s[i]), q, (1.0 / length(d)) * d};
  }
  return best;
}

bool may_cross(Boundary boundary) { return boundary == Boundary::broken_white || boundary == Boundary::none; }

/// Returns nullopt if the lanes are not adjacent there, or if the marking forbids a change.
std::optional<double> beside(const RoadLane& from, std::uint32_t index, const RoadLane& to) {
  const LanePoint& point = from.points[index];
  const Beside other = nearest_of(to, point.p);
  const glm::dvec2 along = base::direction(point.yaw);
  const glm::dvec2 across = other.p - point.p;
  const double width = 0.5 * (from.width + to.width);
  const double apart = length(across);
  if (dot(along, other.tangent) < 0.9 || apart < 0.5 * width || apart > 1.5 * width) return std::nullopt;
  if (std::abs(dot(along, across)) > 0.3 * apart) return std::nullopt;  // beyond one of its ends
  if (!may_cross(base::cross(along, across) > 0.0 ? from.left : from.right)) return std::nullopt;
  return other.s;
}

}  // namespace

std::vector<Transition> lane_changes(const RoadNetwork& network, PointRef at) {
  std::vector<Transition> steps;
  if (at.kind != PointRef::Kind::lane) return steps;
  const RoadLane& lane = network.lanes[at.row];
  const RoadSegment& segment = network.segments[lane.segment];
  if (lane.centre.points.size() < 2) return steps;
  for (std::uint32_t row = segment.first_lane; row < segment.first_lane + segment.lanes; ++row) {
    const RoadLane& other = network.lanes[row];
    if (row == at.row || other.centre.points.size() < 2) continue;
    const auto s = beside(lane, at.index, other);
    if (!s) continue;
    const double least = *s + kWidths * 0.5 * (lane.width + other.width);
    for (std::uint32_t i = 0; i < other.points.size(); ++i) {
      if (other.points[i].s < least) continue;
      const PointRef to{PointRef::Kind::lane, row, i};
      steps.push_back({Transition::Kind::change, to, lane_change_curve(network, at, to).s.back()});
      break;
    }
  }
  return steps;
}

Curve lane_change_curve(const RoadNetwork& network, PointRef from, PointRef to) {
  const LanePoint& a = network.lanes[from.row].points[from.index];
  const LanePoint& b = network.lanes[to.row].points[to.index];
  return connection(a.p, base::direction(a.yaw), b.p, base::direction(b.yaw), {network.tolerance, 0.0, 4096});
}

}  // namespace sf::world
