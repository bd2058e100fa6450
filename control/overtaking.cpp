#include "control/overtaking.h"

#include <algorithm>

namespace sf::control {

namespace {

/// Returns whether the lane is free from `low` to `high` [m] and no robot behind will get there within three seconds at
/// its speed.
bool lane_free(const std::vector<RoadUser>& road_users, std::uint32_t lane, double low, double high) {
  for (std::size_t i = 1; i < road_users.size(); ++i)
    for (const RoadPosition& place : road_users[i].positions)
      if (place.way == lane && place.s > low - 3.0 * road_users[i].speed && place.s < high) return false;
  return true;
}

/// Returns the row of the first change between two lanes at or after `s` [m] along the first; null if there is none.
const std::uint32_t* change_after(const LaneCorridors& corridors, std::uint32_t from, std::uint32_t into, double s) {
  const std::uint32_t* best = nullptr;
  for (const std::uint32_t& row : corridors.way(from).out) {
    const Way& way = corridors.way(row);
    if (way.kind != Way::Kind::change || way.into != into || way.leave < s) continue;
    if (best == nullptr || way.leave < corridors.way(*best).leave) best = &row;
  }
  return best;
}

void add(RoutePlan& plan, std::uint32_t way, double from, double to) {
  plan.legs.push_back({way, from, to, end_of(plan.legs.back())});
}

}  // namespace

bool changes_lanes(const LaneCorridors& corridors, std::uint32_t row) {
  const Way& way = corridors.way(row);
  if (way.kind == Way::Kind::change) return true;
  if (way.kind != Way::Kind::exit || way.at_end || way.from == world::kNone || way.into == world::kNone) return false;
  return corridors.roads().lanes[way.from].segment == corridors.roads().lanes[way.into].segment;
}

std::optional<RoutePlan> plan_return(const LaneCorridors& corridors, const RoutePlan& plan, double s,
                                     const Pose& X_WM) {
  const std::size_t at = leg_at(plan, s);
  const Way& change = corridors.way(plan.legs[at].way);
  // Continue only if the lane that the robot leaves is at least as near as the other one.
  const RoadPosition *left = nullptr, *entered = nullptr;
  const RoadPositions positions = corridors.positions(X_WM, 2.5 * corridors.body().radius);
  for (const RoadPosition& place : positions) {
    if (place.way == change.from) left = &place;
    if (place.way == change.into) entered = &place;
  }
  if (left == nullptr || (entered != nullptr && entered->offset < left->offset)) return std::nullopt;
  const auto& points = corridors.roads().lanes[left->way].points;
  const auto next = std::find_if(points.begin(), points.end(), [&](const auto& p) { return p.s >= left->s; });
  if (next == points.end()) return std::nullopt;
  RoutePlan back = plan;
  back.legs.resize(at);
  back.legs.push_back({left->way, left->s, next->s, s});
  back.node =
      corridors.node_of({world::PointRef::Kind::lane, left->way, static_cast<std::uint32_t>(next - points.begin())});
  std::erase_if(back.goals, [&](const Goal& goal) { return goal.s > s; });
  return back;
}

std::optional<Passing> plan_passing(const LaneCorridors& corridors, const RoutePlan& plan, double s, double speed,
                                    const LeadRobot& slow, const std::vector<RoadUser>& road_users) {
  const std::size_t at = leg_at(plan, s);
  const RouteLeg& leg = plan.legs[at];
  const Way& lane = corridors.way(leg.way);
  if (lane.kind != Way::Kind::lane || at + 1 >= plan.legs.size()) return std::nullopt;
  const double here = leg.from + s - leg.start;
  const double body = 2.0 * corridors.body().radius;
  const double other = std::max(slow.speed, 0.0);
  if (other > 0.8 * speed) return std::nullopt;

  for (const std::uint32_t row : lane.out) {
    const Way& change = corridors.way(row);
    if (change.kind != Way::Kind::change || change.leave < here + 0.05 || change.leave > here + 2.0) continue;
    const std::uint32_t beside = change.into;
    // On the adjacent lane the robot gains on the slower robot at the difference of their speeds, until it is a gap
    // ahead. The lane changes add their own length.
    const double gain = slow.free + 2.0 * body + 0.3;
    const double driven = gain * speed / (speed - other);
    const double back_after = change.enter + std::max(driven - (change.leave - here) - change.length, 0.0);
    const std::uint32_t* back = change_after(corridors, beside, leg.way, back_after);
    if (back == nullptr) continue;
    const Way& home = corridors.way(*back);
    if (home.enter > leg.to) continue;
    if (!lane_free(road_users, beside, change.leave - body - 0.3, home.leave + body)) continue;
    Passing passing{plan, 0.0};
    RoutePlan& p = passing.plan;
    const std::vector<RouteLeg> rest(plan.legs.begin() + static_cast<std::ptrdiff_t>(at) + 1, plan.legs.end());
    p.legs.resize(at + 1);
    p.legs.back().to = change.leave;
    add(p, row, 0.0, change.length);
    add(p, beside, change.enter, home.leave);
    add(p, *back, 0.0, home.length);
    passing.until = end_of(p.legs.back());
    add(p, leg.way, home.enter, leg.to);
    for (const RouteLeg& r : rest) add(p, r.way, r.from, r.to);
    // Checkpoints on the skipped stretch of the lane count as passed.
    const double more = length_of(p) - length_of(plan);
    for (Goal& goal : p.goals)
      if (goal.s > leg.start + change.leave - leg.from) goal.s += more;
    return passing;
  }
  return std::nullopt;
}

}  // namespace sf::control
