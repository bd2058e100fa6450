#include "control/route.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "base/error.h"

namespace sf::control {

namespace {

constexpr double kStands = 0.005;  // [m/s] lower speed limits count as a standstill

}  // namespace

Route::Route(std::shared_ptr<const LaneCorridors> corridors, const ControllerContext& context, RouteSettings settings,
             std::optional<RouteGoals> goals, ConvoyState convoy)
    : corridors_(std::move(corridors)),
      site_(context),
      settings_(settings),
      goals_(std::move(goals)),
      convoy_(convoy),
      lots_(context),
      right_of_way_(*corridors_, context.world.movers[context.mover].id),
      max_turn_(0.8 * context.world.movers[context.mover].max_turn),
      turns_in_place_(context.world.movers[context.mover].drive != world::Drive::car) {}

base::Intent Route::intent() const {
  base::Intent intent;
  intent.follows = convoy_.leader;
  if (started_ && !plan_.goals.empty() && plan_.goals.front().id >= 0)
    intent.checkpoint = static_cast<std::uint32_t>(plan_.goals.front().id);
  intent.docking = started_ && !done_ && corridors_->way(plan_.legs[progress_.leg()].way).in_zone;
  return intent;
}

base::Twist Route::step(const ControllerInput& input) {
  if (!input.started) return {};
  adopt(input);
  if (!started_) start(input);
  const double dt = last_ < 0 ? 0.1 : std::clamp(1e-9 * static_cast<double>(input.time - last_), 0.01, 0.5);
  last_ = input.time;

  progress_.update(*corridors_, plan_, {input.state.X_WM.x, input.state.X_WM.y});
  pass_goals(input);
  right_of_way_.observe(input, convoy_.leader, convoy_.merges);
  follow_leader();
  find_robots_ahead(*corridors_, plan_, progress_.s(), right_of_way_.road_users(), ahead_);
  update_convoy(convoy_, *corridors_, right_of_way_.road_users(), ahead_);
  consider_passing(input);
  reroute(input);
  give_up_change(input);
  trim();
  if (done_) return {};

  Limit limit{settings_.speed, dt};
  limit_by_curvature(limit);
  limit_by_lines(input, limit);
  limit_by_conflict_zones(input, limit);
  limit_by_zones(limit, input);
  limit_by_others(limit);
  const bool stands = limit.speed < kStands;
  why_ = stands ? limit.why : "";
  who_ = stands ? limit.who : base::kNoId;
  return drive(input, limit.speed);
}

std::string Route::stop_reason() const {
  if (done_) return "";
  if (who_ == base::kNoId) return started_ ? why_ : "the start signal has not arrived";
  for (const world::Mover& mover : site_.world.movers)
    if (!mover.is_tag && mover.id == who_) return fmt::format("'{}' {}", mover.name, why_);
  return fmt::format("robot {} {}", who_, why_);
}

base::Twist Route::drive(const ControllerInput& input, double speed) {
  const Pose& X_WM = input.state.X_WM;
  const RouteLeg& leg = plan_.legs[progress_.leg()];
  const Way& way = corridors_->way(leg.way);
  const double at = leg.from + progress_.s() - leg.start;
  const double yaw = yaw_on(way, at);
  offset_ = base::cross(base::direction(yaw), glm::dvec2{X_WM.x, X_WM.y} - point_on(way, at));
  const double heading = base::wrap_angle(X_WM.yaw + (way.backwards ? M_PI : 0.0) - yaw);
  // After a cusp the robot turns in place until it faces along its way.
  const bool kink = progress_.leg() > 0 && cusp_after(*corridors_, plan_, progress_.leg() - 1);
  const bool fresh = kink && at - leg.from < 0.25 * corridors_->body().radius;
  const double on_spot = !turns_in_place_ ? 10.0 : fresh ? 0.02 : 1.0;
  const double reach = 0.9 * corridors_->body().radius;
  // The curvature half a step ahead is the mean over the step.
  base::Twist twist = steer(speed, offset_, heading, curvature_on(way, at + 0.05 * speed), reach, max_turn_, on_spot);
  if (way.backwards) twist.forward = -twist.forward;
  return twist;
}

std::unique_ptr<Controller> make_route_controller(const ControllerContext& context, Settings& settings, bool follows) {
  const world::Mover& mover = context.world.movers[context.mover];
  if (context.roads == nullptr)
    throw base::InputError(context.world.file, 0,
                           "it has no road network to drive on; expected road( rndf \"...\" ) in it");
  RouteSettings s;
  s.speed = settings.number("speed", std::min(follows ? 0.25 : 0.2, mover.max_forward), 0.01, mover.max_forward);
  s.gap = settings.number("gap", follows ? 0.2 : s.gap, 0.01, 100.0);
  s.headway = settings.number("headway", s.headway, 0.3, 10.0);
  s.pass = settings.flag("pass", true);
  s.v2v_range = settings.number("radio", follows ? 12.0 : s.v2v_range, 0.5, 1e6);
  ConvoyState convoy;
  if (follows) {
    if (!settings.has("leader"))
      settings.refuse("leader", "a convoy requires 'leader', the number of the robot to follow");
    convoy.leader = static_cast<std::uint32_t>(settings.number("leader", 0, 0, 4294967294.0));
  } else if (settings.has("merge_behind")) {
    convoy = {static_cast<std::uint32_t>(settings.number("merge_behind", 0, 0, 4294967294.0)), true};
  }
  std::optional<RouteGoals> goals;
  if (!follows) goals.emplace(context, settings);
  auto corridors = shared_lane_corridors(*context.roads, context.world, footprint_of(mover));
  return std::make_unique<Route>(std::move(corridors), context, s, std::move(goals), convoy);
}

namespace {

std::unique_ptr<Controller> make_route(const ControllerContext& context, Settings& settings) {
  return make_route_controller(context, settings, false);
}

}  // namespace

constinit const ControllerType route_controller{
    .name = "route",
    .summary = "drives along the roads from checkpoint to checkpoint, obeying stop lines, lights and the right of way",
    .rate = 10.0,
    .stops_on_bumper = true,
    .make = make_route,
};

}  // namespace sf::control
