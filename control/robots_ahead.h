#pragma once
// Who is ahead on a route, and how far one may go because of them.

#include <vector>

#include "control/right_of_way.h"
#include "control/route_plan.h"

namespace sf::control {

/// A robot in the way.
struct LeadRobot {
  double free = 0.0;      ///< [m] >= 0 that the robot's origin may still go along its route before it is too near
  double speed = 0.0;     ///< [m/s] of the other along the route there; negative: towards it
  std::uint32_t row = 0;  ///< among the road_users
};

/// How far ahead is looked. [m]
inline constexpr double kLookaheadDistance = 2.4;

/// The robots (but the first, itself) that are nearer to the route ahead of `s` than two robots are wide, nearest
/// first. Robots that the route leads away from are none.
void find_robots_ahead(const LaneCorridors& corridors, const RoutePlan& plan, double s,
                       const std::vector<RoadUser>& road_users, std::vector<LeadRobot>& out);

/// Where the route is at `s` [m].
struct OnRoute {
  std::size_t leg = 0;
  glm::dvec2 p;
  double yaw = 0.0;        ///< [rad] of the route
  double curvature = 0.0;  ///< [1/m]
};
OnRoute on_route(const LaneCorridors& corridors, const RoutePlan& plan, double s, std::size_t from_leg = 0);

/// The route turns on the spot, or back, from this leg to the next.
bool cusp_after(const LaneCorridors& corridors, const RoutePlan& plan, std::size_t leg);

/// Goes along with a robot: its place on a route. Never skips a kink that was not reached.
class Progress {
 public:
  double s() const { return s_; }
  std::size_t leg() const { return leg_; }
  void set(double s, std::size_t leg) { s_ = s, leg_ = leg; }
  void update(const LaneCorridors& corridors, const RoutePlan& plan, glm::dvec2 p);

 private:
  double s_ = 0.0;
  std::size_t leg_ = 0;
};

/// Drives a robot along a line: feedback of offset and heading about the line's own curvature (C. Samson, "Path
/// following and time-varying feedback stabilization of a wheeled mobile robot", 1992).
/// @param offset [m] of the robot to the left of the line; heading [rad] of its motion against the line
/// @param reach [m] along which it comes back to the line
base::Twist steer(double speed, double offset, double heading, double curvature, double reach, double max_turn,
                  double turn_on_spot);

}  // namespace sf::control
