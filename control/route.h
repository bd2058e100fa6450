#pragma once
// Drives on a road network from checkpoint to checkpoint as traffic demands: keeps to its lane, stops at stop lines and
// red lights, keeps its distance, waits where others go first, never enters a crossing that it cannot leave.
//
// All speeds are limits; the lowest counts. In a tick a robot
//   1. finds its place on its route, passes checkpoints, plans on;
//   2. takes in who else is on the road (control/right_of_way.h) and who is ahead (control/robots_ahead.h);
//   3. limits its speed by bends, stop lines, conflict_zones, robots ahead, the route's end;
//   4. steers along the line.

#include <memory>
#include <optional>

#include "control/controllers.h"
#include "control/convoy.h"
#include "control/robots_ahead.h"
#include "control/route_goals.h"
#include "control/stop_reason.h"

namespace sf::control {

struct RouteSettings {
  double speed = 0.2;      ///< [m/s] > 0 where nothing is in the way
  double gap = 0.06;       ///< [m] > 0 to the robot ahead when standing, beyond what two robots need
  double headway = 0.8;    ///< [s] > 0 more of it per speed
  bool pass = true;        ///< passes slower robots where there is a lane to
  double v2v_range = 4.0;  ///< [m]
};

class Route : public Controller, public StatesStopReason {
 public:
  Route(std::shared_ptr<const LaneCorridors> corridors, const ControllerContext& context, RouteSettings settings,
        std::optional<RouteGoals> goals, ConvoyState convoy);

  base::Twist step(const ControllerInput& input) override;
  base::Intent intent() const override;
  double v2v_range() const override { return settings_.v2v_range; }
  bool done() const override { return done_; }
  /// Offset to the left of its line. [m]
  double error() const override { return offset_; }
  std::string stop_reason() const override;

  const RoutePlan& plan() const { return plan_; }
  double s() const { return progress_.s(); }            ///< [m] along the plan
  std::uint64_t reached() const { return next_goal_; }  ///< checkpoints so far

 private:
  // The speed limit so far, and its cause.
  struct Limit {
    double speed;
    double dt;
    const char* why = "";
    std::uint32_t who = base::kNoId;                 ///< id of the robot that does
    void stop_in(double distance, const char* why);  ///< [m] before something that it must not pass
  };
  void start(const ControllerInput& input);
  void check_goals() const;
  [[noreturn]] void refuse(const world::RoadCheckpoint& goal) const;
  void fill();
  void trim();
  void pass_goals(const ControllerInput& input);
  void follow_leader();
  void search();
  void consider_passing(const ControllerInput& input);
  void reroute(const ControllerInput& input);
  void give_up_change(const ControllerInput& input);
  bool plan_goals(RoutePlan& plan, std::uint32_t avoid) const;

  void limit_by_curvature(Limit& limit) const;
  void limit_by_lines(const ControllerInput& input, Limit& limit);
  void limit_by_conflict_zones(const ControllerInput& input, Limit& limit);
  void limit_by_zones(Limit& limit, const ControllerInput& input);
  void limit_by_others(Limit& limit) const;
  bool room_beyond(double end) const;
  base::Twist drive(const ControllerInput& input, double speed);

  std::shared_ptr<const LaneCorridors> corridors_;
  const ControllerContext site_;
  RouteSettings settings_;
  std::optional<RouteGoals> goals_;
  ConvoyState convoy_;
  RouteGoals lots_;  ///< where to go while no leader is heard
  RightOfWay right_of_way_;
  double max_turn_;
  bool turns_in_place_;

  RoutePlan plan_;
  bool started_ = false, done_ = false;
  Progress progress_;
  std::uint64_t next_goal_ = 0;  ///< the one it heads for
  std::uint64_t planned_ = 0;    ///< goals that are in the plan or behind
  std::uint64_t searched_ = 0;   ///< lots drawn
  std::vector<LeadRobot> ahead_;
  std::int64_t last_ = -1;  ///< [ns] time of the last step
  double offset_ = 0.0;     ///< [m]
  const char* why_ = "";    ///< it stands, by the last step's limits
  std::uint32_t who_ = base::kNoId;
  double stopped_at_ = -HUGE_VAL;     ///< [m] along the route: the stop line that it stopped at
  std::int64_t standing_since_ = -1;  ///< [ns] at a stop line; -1: it is not
  std::int64_t blocked_since_ = -1;   ///< [ns] that a full lane keeps it waiting; -1: it does not
  std::uint32_t blocked_way_ = world::kNone;
  std::int64_t still_since_ = -1;  ///< [ns] it has stood; -1: it has not begun
  std::int64_t slow_since_ = -1;   ///< [ns] behind a slower one; -1: not
  double pass_until_ = -1.0;       ///< [m] along the route: until there it passes
};

extern const ControllerType route_controller;

/// A controller from settings: `speed`, `gap`, `headway`, `pass`, `merge_behind`, those of RouteGoals; `leader` for
/// convoys.
/// @throws base::InputError
std::unique_ptr<Controller> make_route_controller(const ControllerContext& context, Settings& settings, bool follows);

}  // namespace sf::control
