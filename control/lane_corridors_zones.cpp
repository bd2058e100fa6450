// Ways within zones: into parking spots, out of them, and across.

#include <algorithm>
#include <array>
#include <cmath>

#include "base/elementary.h"
#include "control/lane_corridors.h"

namespace sf::control {

namespace {

using world::PointRef;

world::Curve straight(glm::dvec2 a, glm::dvec2 b) { return world::smooth_curve(std::array{a, b}, {}); }

}  // namespace

Pose LaneCorridors::parked(std::uint32_t row) const {
  const world::RoadSpot& spot = roads_.spots[row];
  const glm::dvec2 d = spot.end - spot.entry;
  const glm::dvec2 along = length(d) > 0.0 ? (1.0 / length(d)) * d : glm::dvec2{1.0, 0.0};
  const glm::dvec2 p = spot.end - body_.front * along;
  return {p.x, p.y, 0.0, base::atan2(along.y, along.x)};
}

// A way into a spot leads along the aisle to the place in front of it, turns in place, and continues straight in. A way
// out is driven in reverse.
void LaneCorridors::add_zones() {
  const auto leads = [&](PointRef at, bool out) {
    return std::any_of(roads_.exits.begin(), roads_.exits.end(),
                       [&](const world::RoadExit& exit) { return (out ? exit.from : exit.to) == at; });
  };
  for (std::uint32_t row = 0; row < roads_.zones.size(); ++row) {
    const world::RoadZone& zone = roads_.zones[row];
    const Way about{.kind = Way::Kind::zone, .in_zone = true, .zone = row};
    const auto aisle = [&](glm::dvec2 a, glm::dvec2 b) { return add_way(about, straight(a, b)); };
    for (std::uint32_t i = 0; i < zone.perimeter.size(); ++i) {
      const PointRef here{PointRef::Kind::perimeter, row, i};
      for (std::uint32_t j = 0; j < zone.perimeter.size(); ++j) {
        const PointRef there{PointRef::Kind::perimeter, row, j};
        if (i == j || !leads(here, false) || !leads(there, true)) continue;
        const std::uint32_t way = aisle(zone.perimeter[i].p, zone.perimeter[j].p);
        add_edge(here, there, way, 0.0, ways_[way].length, 0.0);
      }
      for (std::uint32_t spot = zone.first_spot; spot < zone.first_spot + zone.spots; ++spot) {
        const PointRef entry{PointRef::Kind::spot, spot, 0}, end{PointRef::Kind::spot, spot, 1};
        const Pose stand = parked(spot);
        const glm::dvec2 in{stand.x, stand.y};
        const glm::dvec2 before = roads_.spots[spot].entry - body_.radius * base::direction(stand.yaw);
        if (leads(here, false)) {
          const std::uint32_t way = aisle(zone.perimeter[i].p, before);
          add_edge(here, entry, way, 0.0, ways_[way].length, 0.0);
          if (edges_[node_of(entry)].empty()) {
            const std::uint32_t dock = aisle(before, in);
            add_edge(entry, end, dock, 0.0, ways_[dock].length, 0.0);
          }
        }
        if (leads(here, true)) {
          const std::uint32_t back = aisle(in, before);
          ways_[back].backwards = true;
          const std::uint32_t way = aisle(before, zone.perimeter[i].p);
          edges_[node_of(end)].push_back(
              {node_of(here), {back, way}, 0.0, ways_[back].length, ways_[back].length + ways_[way].length});
        }
      }
    }
  }
}

bool LaneCorridors::inside(std::uint32_t zone, glm::dvec2 p) const {
  const auto& perimeter = roads_.zones[zone].perimeter;
  bool in = false;
  for (std::size_t i = 0, j = perimeter.size() - 1; i < perimeter.size(); j = i++) {
    const glm::dvec2 a = perimeter[i].p, b = perimeter[j].p;
    const glm::dvec2 d = b - a;
    const double t = std::clamp(dot(p - a, d) / std::max(dot(d, d), 1e-18), 0.0, 1.0);
    if (length(p - a - t * d) < 0.5 * body_.radius) return true;
    if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) in = !in;
  }
  return in;
}

}  // namespace sf::control
