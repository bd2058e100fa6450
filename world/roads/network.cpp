#include "world/roads/network.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

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
    return std::atan2(along.y, along.x);
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
    return yaw ? glm::dvec2{std::cos(*yaw), std::sin(*yaw)} : straight;
  };
  return connection(a, direction(exit.from), b, direction(exit.to), {network.tolerance, 0.0, 4096});
}

}  // namespace sf::world
