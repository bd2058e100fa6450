#pragma once
// Drives on a road network from checkpoint to checkpoint in traffic: keeps to its lane, stops at stop lines and red
// lights, keeps its distance, yields the right of way, and never enters a crossing that it cannot leave.
//
// Each rule sets a speed limit, and the lowest applies. Each step
//   1. updates the position on the route, passes checkpoints, extends the plan; replans if lanes are used in another
//   way;
//   2. observes the road users (control/right_of_way.h) and the robots ahead (control/robots_ahead.h);
//   3. limits the speed by curvature, stop lines, conflict zones, robots ahead and the end of the route;
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
  double speed = 0.2;      ///< [m/s] > 0 on a free road
  double gap = 0.06;       ///< [m] > 0 to the robot ahead at a standstill, in addition to the size of both robots
  double headway = 0.8;    ///< [s] > 0 additional gap per speed
  bool pass = true;        ///< overtakes slower robots if there is an adjacent lane
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
  /// Returns the offset [m] to the left of the line.
  double error() const override { return offset_; }
  std::string stop_reason() const override;

  const RoutePlan& plan() const { return plan_; }
  double s() const { return progress_.s(); }            ///< [m] along the plan
  std::uint64_t reached() const { return next_goal_; }  ///< checkpoints passed

 private:
  // Speed limit so far, and its cause.
  struct Limit {
    double speed;
    double dt;
    const char* why = "";
    std::uint32_t who = base::kNoId;                 ///< id of the robot that causes it; kNoId: none
    void stop_in(double distance, const char* why);  ///< @param distance [m] to the place to stop at
  };
  void start(const ControllerInput& input);
  void adopt(const ControllerInput& input);
  world::RoadCheckpoint here(const world::RoadCheckpoint& goal) const;
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

  std::shared_ptr<const world::RoadNetwork> roads_;  ///< of `corridors_`; null: as at the start
  std::shared_ptr<const LaneCorridors> corridors_;
  const ControllerContext site_;
  RouteSettings settings_;
  std::optional<RouteGoals> goals_;
  ConvoyState convoy_;
  RouteGoals lots_;  ///< random goals while no leader is in range
  RightOfWay right_of_way_;
  double max_turn_;
  bool turns_in_place_;

  RoutePlan plan_;
  bool started_ = false, done_ = false;
  Progress progress_;
  std::uint64_t next_goal_ = 0;  ///< index of the current goal
  std::uint64_t planned_ = 0;    ///< goals in the plan or passed
  std::uint64_t searched_ = 0;   ///< random goals drawn
  bool unreachable_ = false;     ///< no open lane leads to the next goal to plan
  std::vector<LeadRobot> ahead_;
  std::int64_t last_ = -1;  ///< [ns] time of the last step
  double offset_ = 0.0;     ///< [m]
  const char* why_ = "";    ///< cause of the standstill at the last step; empty: the robot drives
  std::uint32_t who_ = base::kNoId;
  double stopped_at_ = -HUGE_VAL;     ///< [m] along the route: last stop line at which the robot has stopped
  std::int64_t standing_since_ = -1;  ///< [ns] since when it has stopped at a stop line; -1: it has not
  std::int64_t blocked_since_ = -1;   ///< [ns] waiting for room on a full lane; -1: not waiting
  std::uint32_t blocked_way_ = world::kNone;
  std::int64_t still_since_ = -1;  ///< [ns] start of the standstill; -1: before the first step
  std::int64_t slow_since_ = -1;   ///< [ns] since when it is behind a slower robot; -1: it is not
  double pass_until_ = -1.0;       ///< [m] along the route: end of the current overtaking
};

extern const ControllerType route_controller;

/// Creates a route or convoy controller from the settings `speed`, `gap`, `headway`, `pass`, `radio`, `merge_behind`,
/// and for routes those of RouteGoals, for convoys `leader`.
/// @param follows true: convoy
/// @throws base::InputError
std::unique_ptr<Controller> make_route_controller(const ControllerContext& context, Settings& settings, bool follows);

}  // namespace sf::control
