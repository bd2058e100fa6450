#pragma once
// Routes through a list of checkpoints: shortest paths in metres on the graph of ways (E. W. Dijkstra, "A note on two
// problems in connexion with graphs", Numer. Math. 1, 1959). A lane change costs a little more than its length.
//
//   RoutePlan plan = plan_from(corridors, *locate_on_road(corridors, X_WM));
//   if (extend(corridors, plan, checkpoint)) drive(plan.legs[leg_at(plan, s)]);

#include <cstdint>
#include <optional>
#include <vector>

#include "control/lane_corridors.h"

namespace sf::control {

/// A stretch of one way.
struct RouteLeg {
  std::uint32_t way = 0;
  double from = 0.0, to = 0.0;  ///< [m] along the way; to >= from
  double start = 0.0;           ///< [m] along the route
};
inline double end_of(const RouteLeg& leg) { return leg.start + leg.to - leg.from; }

/// A checkpoint on the route.
struct Goal {
  int id = 0;
  double s = 0.0;     ///< [m] along the route
  bool park = false;  ///< it is the end of a parking spot
};

/// A route: consecutive legs. Positions along it are in metres from the start of the first plan; legs that the robot
/// has passed may have been dropped.
struct RoutePlan {
  std::vector<RouteLeg> legs;  ///< at least one
  std::vector<Goal> goals;
  std::uint32_t node = 0;  ///< node of the graph at its end
};
inline double length_of(const RoutePlan& plan) { return end_of(plan.legs.back()); }

/// Returns the index of the first point of a lane at or after `s` [m], or of the last point if there is none.
std::uint32_t point_from(const world::RoadLane& lane, double s);

/// Returns the index of the leg at `s` [m] along the route; the first or last leg beyond its ends.
std::size_t leg_at(const RoutePlan& plan, double s);

/// Returns the lane at a robot's pose, in its direction, and the position along it; nullopt if there is none nearby.
std::optional<RoadPosition> locate_on_lane(const LaneCorridors& corridors, const Pose& X_WM);
/// Does the same, including exits between lanes.
std::optional<RoadPosition> locate_on_road(const LaneCorridors& corridors, const Pose& X_WM);
/// Returns the parking spot at a robot's pose.
std::optional<std::uint32_t> spot_at(const LaneCorridors& corridors, const Pose& X_WM);

/// Returns a route of one leg: from the position to the next point of its lane, or to the end of its exit.
RoutePlan plan_from(const LaneCorridors& corridors, const RoadPosition& place);
/// Returns a route that begins where a robot is parked.
RoutePlan plan_from_spot(const LaneCorridors& corridors, std::uint32_t spot);

/// Extends the plan to a checkpoint (second form: to a point of the network). A robot that is already there drives at
/// least one edge.
/// @param avoid row of a way to exclude; kNone: none
/// @return false without a path; the plan is then unchanged
bool extend(const LaneCorridors& corridors, RoutePlan& plan, const world::RoadCheckpoint& to,
            std::uint32_t avoid = world::kNone);
bool extend(const LaneCorridors& corridors, RoutePlan& plan, world::PointRef to, std::uint32_t avoid = world::kNone);

/// Truncates the plan at the first point of a lane after `s` and drops the goals after `s`. Keeps legs through a zone
/// up to the next lane, or all of them if the plan ends in the zone.
void cut_after(const LaneCorridors& corridors, RoutePlan& plan, double s);

/// Moves a plan to the same ways of corridors of other lane uses. Drops passed legs, and legs ahead up to the plan's
/// end, from the first one whose way no longer exists, with their goals.
/// @param leg the current one
/// @return number of passed legs dropped; nullopt if the way of the current leg no longer exists, and the plan is
/// undefined
std::optional<std::size_t> moved_to(const LaneCorridors& from, const LaneCorridors& to, RoutePlan& plan,
                                    std::size_t leg);

/// Returns random start poses for `count` robots on lanes, in driving direction, at least `apart` [m] from each other
/// and from the lanes' ends. Depends only on the arguments.
/// @throws base::InputError if there is no room for that many
std::vector<Pose> start_poses(const world::RoadNetwork& roads, std::size_t count, std::uint64_t seed, double apart);

}  // namespace sf::control
