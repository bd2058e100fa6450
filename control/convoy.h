#pragma once
// Who drives together: a convoy is a chain of robots, each following the one ahead of it wherever that one goes. Whom a
// robot follows it tells all (V2V), and no more is needed:
//
//   - A follower plans its way to where its leader is, again whenever that is somewhere else, and keeps its gap.
//   - Who wants to come into the convoy behind X says so: it follows X as well. The member that followed X falls back
//     until there is room for it, and once it is there follows the newcomer instead.

#include <cstdint>
#include <optional>
#include <vector>

#include "base/report.h"
#include "control/controllers.h"
#include "control/robots_ahead.h"

namespace sf::control {

/// Whom a robot follows.
struct ConvoyState {
  std::uint32_t leader = base::kNoId;  ///< id; nobody: it goes its own way
  bool merges = false;                 ///< it still has to come in behind the leader
};

/// The row of a robot among the road_users; nothing when it is not in sight.
std::optional<std::uint32_t> row_of(const std::vector<RoadUser>& road_users, std::uint32_t id);

/// The point of the graph that a robot will come to next.
std::optional<std::uint32_t> heading_for(const LaneCorridors& corridors, const RoadUser& driver);

/// Keeps the company in order after a look around: who merges and is there has merged, who comes in between becomes the
/// leader.
void update_convoy(ConvoyState& convoy, const LaneCorridors& corridors, const std::vector<RoadUser>& road_users,
                   const std::vector<LeadRobot>& ahead);

/// The gap that a member opens for a newcomer. [m] beyond its own; 0: nobody wants to come in
double opened_gap(const ConvoyState& convoy, const LaneCorridors& corridors, const std::vector<RoadUser>& road_users);

/// Somebody follows this robot and has fallen behind: it is to be waited for.
bool follower_lags(const std::vector<RoadUser>& road_users);

extern const ControllerType convoy_controller;

}  // namespace sf::control
