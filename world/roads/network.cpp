#include "world/roads/network.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace sf::world {

namespace {

bool before(const PointRef& a, const PointRef& b) {
  if (a.kind != b.kind) return a.kind < b.kind;
  return a.row != b.row ? a.row < b.row : a.index < b.index;
}

struct ByFrom {
  bool operator()(const RoadExit& a, const PointRef& b) const { return before(a.from, b); }
  bool operator()(const PointRef& a, const RoadExit& b) const { return before(a, b.from); }
};

std::pair<std::vector<RoadExit>::const_iterator, std::vector<RoadExit>::const_iterator> exits_from(
    const RoadNetwork& network, PointRef at) {
  return std::equal_range(network.exits.begin(), network.exits.end(), at, ByFrom{});
}

Transition across(const RoadNetwork& network, PointRef from, PointRef to) {
  return {Transition::Kind::zone, to, length(position_of(network, to) - position_of(network, from))};
}

/// Adds transitions across a zone to all of its perimeter points with exits.
void add_ways_out(const RoadNetwork& network, std::uint32_t zone, PointRef from, std::vector<Transition>& steps) {
  const auto points = static_cast<std::uint32_t>(network.zones[zone].perimeter.size());
  for (std::uint32_t i = 0; i < points; ++i) {
    const PointRef to{PointRef::Kind::perimeter, zone, i};
    const auto [first, last] = exits_from(network, to);
    if (first != last && to != from) steps.push_back(across(network, from, to));
  }
}

}  // namespace

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
    return std::atan2(along.y, along.x);
  }
  const RoadLane& lane = network.lanes[at.row];
  if (lane.centre.points.size() < 2) return std::nullopt;
  return lane.points[at.index].yaw;
}

std::string name_of(const RoadNetwork& network, const RoadLane& lane) {
  return fmt::format("{}.{}", network.segments[lane.segment].id, lane.number);
}

std::vector<Transition> successors(const RoadNetwork& network, PointRef at) {
  std::vector<Transition> steps;
  if (at.kind == PointRef::Kind::lane) {
    const std::vector<LanePoint>& points = network.lanes[at.row].points;
    if (at.index + 1 < points.size())
      steps.push_back({Transition::Kind::lane,
                       {PointRef::Kind::lane, at.row, at.index + 1},
                       points[at.index + 1].s - points[at.index].s});
  }
  const auto [first, last] = exits_from(network, at);
  for (auto exit = first; exit != last; ++exit) steps.push_back({Transition::Kind::exit, exit->to, exit->length});
  if (at.kind == PointRef::Kind::perimeter) {
    const RoadZone& zone = network.zones[at.row];
    for (std::uint32_t i = 0; i < zone.spots; ++i)
      steps.push_back(across(network, at, {PointRef::Kind::spot, zone.first_spot + i, 0}));
    add_ways_out(network, at.row, at, steps);
  } else if (at.kind == PointRef::Kind::spot) {
    if (at.index == 0) steps.push_back(across(network, at, {PointRef::Kind::spot, at.row, 1}));
    if (at.index == 1) add_ways_out(network, network.spots[at.row].zone, at, steps);
  }
  return steps;
}

Curve exit_curve(const RoadNetwork& network, const RoadExit& exit) {
  const glm::dvec2 a = position_of(network, exit.from);
  const glm::dvec2 b = position_of(network, exit.to);
  const double d = length(b - a);
  const glm::dvec2 straight = d > 0.0 ? (1.0 / d) * (b - a) : glm::dvec2{1.0, 0.0};
  const auto direction = [&](PointRef at) {
    const auto yaw = yaw_of(network, at);
    return yaw ? glm::dvec2{std::cos(*yaw), std::sin(*yaw)} : straight;
  };
  return connection(a, direction(exit.from), b, direction(exit.to), {network.tolerance, 0.0, 4096});
}

}  // namespace sf::world
