#pragma once
// Convoys. A convoy is a chain of robots in which each follows the robot ahead of it. Each robot broadcasts the id of
// its leader (V2V); no other communication is needed:
//
//   - A follower plans its route to the leader's position, replans whenever that position changes, and keeps its gap.
//   - A newcomer that is to merge behind robot X announces X as its leader. The member that followed X falls back until
//     there is room, and follows the newcomer once it has merged.

#include <cstdint>
#include <optional>
#include <vector>

#include "base/report.h"
#include "control/controllers.h"
#include "control/robots_ahead.h"

namespace sf::control {

/// Leader of a robot.
struct ConvoyState {
  std::uint32_t leader = base::kNoId;  ///< id; kNoId: the robot follows no other
  bool merges = false;                 ///< the robot has yet to merge behind the leader
};

/// Returns the row of a robot among the road users; nullopt if it is not in range.
std::optional<std::uint32_t> row_of(const std::vector<RoadUser>& road_users, std::uint32_t id);

/// Returns the next node of the graph on a robot's way.
std::optional<std::uint32_t> heading_for(const LaneCorridors& corridors, const RoadUser& driver);

/// Updates the leader after an observation. A merge is complete when the leader is the next robot ahead on the same
/// lane. A newcomer that drives between this robot and its leader becomes the leader.
void update_convoy(ConvoyState& convoy, const LaneCorridors& corridors, const std::vector<RoadUser>& road_users,
                   const std::vector<LeadRobot>& ahead);

/// Returns the gap [m] to open for a newcomer, in addition to the convoy's own; 0 without a newcomer.
double opened_gap(const ConvoyState& convoy, const LaneCorridors& corridors, const std::vector<RoadUser>& road_users);

/// Returns whether a follower of this robot has fallen behind, so that this robot has to wait for it.
bool follower_lags(const std::vector<RoadUser>& road_users);

extern const ControllerType convoy_controller;

}  // namespace sf::control
