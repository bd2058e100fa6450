#pragma once
// Robots ahead on a route, progress along it, and path tracking.

#include <vector>

#include "control/right_of_way.h"
#include "control/route_plan.h"

namespace sf::control {

/// A robot ahead on the route.
struct LeadRobot {
  double free = 0.0;      ///< [m] >= 0 free distance of the robot's origin along its route to the other robot
  double speed = 0.0;     ///< [m/s] of the other robot along the route there; negative: oncoming
  std::uint32_t row = 0;  ///< row in `RightOfWay::road_users()`
};

/// [m] Length of route that is checked.
inline constexpr double kLookaheadDistance = 2.4;

/// Finds the robots (except the first, itself) that are nearer than about two radii to the route ahead of `s`, nearest
/// first. Excludes robots that the route leads away from.
void find_robots_ahead(const LaneCorridors& corridors, const RoutePlan& plan, double s,
                       const std::vector<RoadUser>& road_users, std::vector<LeadRobot>& out);

/// The route at one place.
struct OnRoute {
  std::size_t leg = 0;
  glm::dvec2 p;
  double yaw = 0.0;        ///< [rad] yaw of the route
  double curvature = 0.0;  ///< [1/m]
  double z = 0.0;          ///< [m]
};
OnRoute on_route(const LaneCorridors& corridors, const RoutePlan& plan, double s, std::size_t from_leg = 0);

/// Returns whether the route turns in place or reverses between this leg and the next.
bool cusp_after(const LaneCorridors& corridors, const RoutePlan& plan, std::size_t leg);

/// Progress of a robot along a route. Never skips a cusp that the robot has not reached.
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

/// Path tracking by feedback of offset and heading, with the curvature of the line (C. Samson, "Path following and
/// time-varying feedback stabilization of a wheeled mobile robot", 1992).
/// @param offset [m] of the robot to the left of the line
/// @param heading [rad] of its motion relative to the line
/// @param reach [m] length within which it returns to the line
/// @param turn_on_spot [rad] a larger heading error results in a turn in place
base::Twist steer(double speed, double offset, double heading, double curvature, double reach, double max_turn,
                  double turn_on_spot);

}  // namespace sf::control
