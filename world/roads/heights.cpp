// Heights of roads.

#include <algorithm>

#include "world/roads/network.h"

namespace sf::world {

namespace {

/// Adds the pieces of a curve that are above the floor. @param z_at returns the height [m] at a length [m] along it
template <class HeightAt>
void add_ramps(const Curve& curve, double half_width, HeightAt z_at, std::vector<Ramp>& ramps) {
  for (std::size_t i = 1; i < curve.points.size(); ++i) {
    const Ramp ramp{curve.points[i - 1], curve.points[i], z_at(curve.s[i - 1]), z_at(curve.s[i]), half_width};
    if (ramp.z_a != 0.0 || ramp.z_b != 0.0) ramps.push_back(ramp);
  }
}

bool is_raised(const RoadLane& lane) {
  return std::any_of(lane.points.begin(), lane.points.end(), [](const LanePoint& point) { return point.z != 0.0; });
}

}  // namespace

double height_of(const RoadNetwork& network, PointRef at) {
  return at.kind == PointRef::Kind::lane ? network.lanes[at.row].points[at.index].z : 0.0;
}

double height_at(const RoadLane& lane, double s) {
  const auto next = std::upper_bound(lane.points.begin(), lane.points.end(), s,
                                     [](double length, const LanePoint& point) { return length < point.s; });
  if (next == lane.points.begin()) return next->z;
  const LanePoint& before = *(next - 1);
  if (next == lane.points.end()) return before.z;
  return before.z + (s - before.s) / (next->s - before.s) * (next->z - before.z);
}

std::vector<Ramp> ramps_of(const RoadNetwork& network) {
  std::vector<Ramp> ramps;
  for (const RoadLane& lane : network.lanes)
    if (is_raised(lane))
      add_ramps(
          lane.centre, 0.5 * lane.width, [&](double s) { return height_at(lane, s); }, ramps);
  for (const RoadExit& exit : network.exits) {
    const double from = height_of(network, exit.from), to = height_of(network, exit.to);
    if (from == 0.0 && to == 0.0) continue;
    const PointRef lane = exit.from.kind == PointRef::Kind::lane ? exit.from : exit.to;
    const Curve curve = exit_curve(network, exit);
    const double length = curve.s.back();
    add_ramps(
        curve, 0.5 * network.lanes[lane.row].width,
        [&](double s) { return length > 0.0 ? from + s / length * (to - from) : to; }, ramps);
  }
  return ramps;
}

}  // namespace sf::world
