#pragma once
// The way through a list of checkpoints: shortest in metres over the graph of ways (E. W. Dijkstra, "A note on two
// problems in connexion with graphs", Numer. Math. 1, 1959), changes of lanes a little dearer than they are long.
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
  double start = 0.0;           ///< [m] along the route where it begins
};
inline double end_of(const RouteLeg& leg) { return leg.start + leg.to - leg.from; }

/// A checkpoint on the route.
struct Goal {
  int id = 0;
  double s = 0.0;     ///< [m] along the route
  bool park = false;  ///< it is the end of a parking spot
};

/// A route: legs one after another, each beginning where the one before ends. Positions along it are metres from where
/// it was first planned; legs that are done may have been dropped.
struct RoutePlan {
  std::vector<RouteLeg> legs;  ///< at least one
  std::vector<Goal> goals;
  std::uint32_t node = 0;  ///< where it ends
};
inline double length_of(const RoutePlan& plan) { return end_of(plan.legs.back()); }

/// The first point of a lane at `s` [m] or after it, else its last.
std::uint32_t point_from(const world::RoadLane& lane, double s);

/// The leg at `s` [m] along the route; the first or last beyond its ends.
std::size_t leg_at(const RoutePlan& plan, double s);

/// The lane that a robot stands on, and how far along; nothing when there is none near in its direction.
std::optional<RoadPosition> locate_on_lane(const LaneCorridors& corridors, const Pose& X_WM);
/// Likewise, between lanes the exit that leads to one.
std::optional<RoadPosition> locate_on_road(const LaneCorridors& corridors, const Pose& X_WM);
/// Likewise the parking spot.
std::optional<std::uint32_t> spot_at(const LaneCorridors& corridors, const Pose& X_WM);

/// A route of one leg: from the place to the next point of its lane, or the end of its exit.
RoutePlan plan_from(const LaneCorridors& corridors, const RoadPosition& place);
/// A route that begins where a robot is parked.
RoutePlan plan_from_spot(const LaneCorridors& corridors, std::uint32_t spot);

/// Goes on to a checkpoint (to `at` where it has none), at least one edge far when it is there already.
/// @param avoid a way that is not to be taken; kNone: none
/// @return false, and nothing changed, when there is no way
bool extend(const LaneCorridors& corridors, RoutePlan& plan, const world::RoadCheckpoint& to,
            std::uint32_t avoid = world::kNone);
bool extend(const LaneCorridors& corridors, RoutePlan& plan, world::PointRef to, std::uint32_t avoid = world::kNone);

/// Forgets all that comes after the point of a lane that is next after `s`, and the goals after `s`: the plan ends
/// there. What leads through a zone is kept as far as the next lane, or whole where it ends in the zone.
void cut_after(const LaneCorridors& corridors, RoutePlan& plan, double s);

/// Poses for `count` robots on lanes, along their lanes, at least `apart` [m] from each other and from the lanes' ends:
/// for crowds. Drawn from the seed alone.
/// @throws base::InputError when so many find no room.
std::vector<Pose> start_poses(const world::RoadNetwork& roads, std::size_t count, std::uint64_t seed, double apart);

}  // namespace sf::control
