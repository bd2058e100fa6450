#include "control/convoy.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "control/route.h"

namespace sf::control {

namespace {

constexpr double kNewcomerDistance = 2.5;  // [m] distance of a newcomer at which the gap is opened
constexpr double kBehind = 1.2;            // [m] distance at which a follower has fallen behind

/// Returns the row of another follower of the same leader.
std::optional<std::uint32_t> newcomer(const ConvoyState& convoy, const std::vector<RoadUser>& road_users) {
  if (convoy.leader == base::kNoId || convoy.merges) return std::nullopt;
  for (std::uint32_t row = 1; row < road_users.size(); ++row)
    if (road_users[row].follows == convoy.leader) return row;
  return std::nullopt;
}

bool on_one_lane(const LaneCorridors& corridors, const RoadUser& driver, const RoadUser& ahead) {
  for (const RoadPosition& own : driver.positions)
    for (const RoadPosition& other : ahead.positions)
      if (other.way == own.way && corridors.way(own.way).kind == Way::Kind::lane) return true;
  return false;
}

}  // namespace

std::optional<std::uint32_t> row_of(const std::vector<RoadUser>& road_users, std::uint32_t id) {
  for (std::uint32_t row = 1; row < road_users.size(); ++row)
    if (road_users[row].id == id) return row;
  return std::nullopt;
}

std::optional<std::uint32_t> heading_for(const LaneCorridors& corridors, const RoadUser& driver) {
  // Near a branch the robot is on several ways. It counts as on the lane until it has left the lane.
  for (const bool lane : {true, false})
    for (const RoadPosition& place : driver.positions) {
      const Way& way = corridors.way(place.way);
      const std::uint32_t row = lane ? place.way : way.into;
      if (lane != (way.kind == Way::Kind::lane) || row == world::kNone) continue;
      const std::uint32_t next = point_from(corridors.roads().lanes[row], lane ? place.s : way.enter);
      return corridors.node_of({world::PointRef::Kind::lane, row, next});
    }
  return std::nullopt;
}

void update_convoy(ConvoyState& convoy, const LaneCorridors& corridors, const std::vector<RoadUser>& road_users,
                   const std::vector<LeadRobot>& ahead) {
  if (convoy.leader == base::kNoId || ahead.empty()) return;
  const RoadUser& next = road_users[ahead.front().row];
  if (convoy.merges) {
    if (next.id == convoy.leader && on_one_lane(corridors, road_users.front(), next)) convoy.merges = false;
    return;
  }
  const auto row = newcomer(convoy, road_users);
  if (row && next.id == road_users[*row].id) convoy.leader = next.id;
}

double opened_gap(const ConvoyState& convoy, const LaneCorridors& corridors, const std::vector<RoadUser>& road_users) {
  const auto row = newcomer(convoy, road_users);
  if (!row) return 0.0;
  const Pose& a = road_users[0].X_WM;
  const Pose& b = road_users[*row].X_WM;
  return base::hypot(a.x - b.x, a.y - b.y) < kNewcomerDistance ? 2.0 * corridors.body().radius + 0.3 : 0.0;
}

bool follower_lags(const std::vector<RoadUser>& road_users) {
  const Pose& here = road_users.front().X_WM;
  return std::any_of(road_users.begin() + 1, road_users.end(), [&](const RoadUser& other) {
    return other.follows == road_users.front().id &&
           base::hypot(other.X_WM.x - here.x, other.X_WM.y - here.y) > kBehind;
  });
}

namespace {

std::unique_ptr<Controller> make_convoy(const ControllerContext& context, Settings& settings) {
  return make_route_controller(context, settings, true);
}

}  // namespace

constinit const ControllerType convoy_controller{
    .name = "convoy",
    .summary = "follows another robot along the roads at a fixed gap and lets others merge",
    .rate = 10.0,
    .stops_on_bumper = true,
    .make = make_convoy,
};

}  // namespace sf::control
