#pragma once
// The transitions of a road network, point by point. Tests of routes use this instead of the code under test.

#include <vector>

#include "world/roads/network.h"

namespace sf::world {

/// Returns the transitions from `at`: along the lane and by its exits; from a perimeter point also to each spot of the
/// zone and to each perimeter point with exits; within a spot to its end, and from its end to each perimeter point with
/// exits.
inline std::vector<Transition> successors(const RoadNetwork& network, PointRef at) {
  using Kind = PointRef::Kind;
  std::vector<Transition> steps;
  const auto across = [&](PointRef to) {
    steps.push_back({Transition::Kind::zone, to, length(position_of(network, to) - position_of(network, at))});
  };
  const auto ways_out = [&](std::uint32_t zone) {
    for (std::uint32_t i = 0; i < network.zones[zone].perimeter.size(); ++i) {
      const PointRef to{Kind::perimeter, zone, i};
      bool leaves = false;
      for (const RoadExit& exit : network.exits) leaves = leaves || exit.from == to;
      if (leaves && to != at) across(to);
    }
  };
  if (at.kind == Kind::lane) {
    const std::vector<LanePoint>& points = network.lanes[at.row].points;
    if (at.index + 1 < points.size())
      steps.push_back(
          {Transition::Kind::lane, {Kind::lane, at.row, at.index + 1}, points[at.index + 1].s - points[at.index].s});
  }
  for (const RoadExit& exit : network.exits)
    if (exit.from == at) steps.push_back({Transition::Kind::exit, exit.to, exit.length});
  if (at.kind == Kind::perimeter) {
    const RoadZone& zone = network.zones[at.row];
    for (std::uint32_t i = 0; i < zone.spots; ++i) across({Kind::spot, zone.first_spot + i, 0});
    ways_out(at.row);
  } else if (at.kind == Kind::spot) {
    if (at.index == 0) across({Kind::spot, at.row, 1});
    if (at.index == 1) ways_out(network.spots[at.row].zone);
  }
  return steps;
}

}  // namespace sf::world
