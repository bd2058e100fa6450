#include "control/route.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "control/passing.h"

namespace sf::control {

namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::size_t kOldLegs = 24;  // that are done are kept

}  // namespace

Route::Route(std::shared_ptr<const Corridors> corridors, const Site& site, RouteSettings settings,
             std::optional<RouteGoals> goals, Company company)
    : corridors_(std::move(corridors)),
      site_(site),
      settings_(settings),
      goals_(std::move(goals)),
      company_(company),
      lots_(site),
      right_of_way_(*corridors_, site.world.movers[site.mover].id),
      max_turn_(0.8 * site.world.movers[site.mover].max_turn),
      turns_in_place_(site.world.movers[site.mover].drive != world::Drive::car) {}

base::Intent Route::intent() const {
  base::Intent intent;
  intent.follows = company_.leader;
  if (started_ && !plan_.goals.empty() && plan_.goals.front().id >= 0)
    intent.checkpoint = static_cast<std::uint32_t>(plan_.goals.front().id);
  intent.docking = started_ && !done_ && corridors_->way(plan_.legs[progress_.leg()].way).in_zone;
  return intent;
}

// ---- Planning.

void Route::start(const Input& input) {
  const Pose& X_WM = input.state.X_WM;
  if (const auto spot = spot_at(*corridors_, X_WM)) {
    plan_ = plan_from_spot(*corridors_, *spot);
  } else {
    const auto place = place_on_road(*corridors_, X_WM);
    if (!place)
      throw base::InputError(
          fmt::format("robot '{}' stands at ({:.2f}, {:.2f}), where no lane of '{}' runs in its "
                      "direction; place it on a lane or in a parking spot",
                      site_.world.movers[site_.mover].name, X_WM.x, X_WM.y, site_.roads->file));
    plan_ = plan_from(*corridors_, *place);
  }
  started_ = true;
  check_goals();
  fill();
}

// A list is tried out once, to its end and back to its beginning, so that nobody is stranded on the way.
void Route::check_goals() const {
  if (!goals_) return;
  RoutePlan plan = plan_;
  for (std::size_t k = 0; k <= goals_->count(); ++k) {
    const world::RoadCheckpoint* goal = goals_->by_lot() ? nullptr : goals_->at(k);
    if (goal == nullptr) return;
    if (!extend(*corridors_, plan, *goal)) refuse(*goal);
  }
}

void Route::refuse(const world::RoadCheckpoint& goal) const {
  throw base::InputError(fmt::format(
      "robot '{}' finds no way to checkpoint {} (way-point {}) in '{}'; choose others, or add exits",
      site_.world.movers[site_.mover].name, goal.id, text_of(id_of(*site_.roads, goal.at)), site_.roads->file));
}

// Two goals ahead are planned, so that there is always some way on from the next one.
void Route::fill() {
  if (!goals_) return;
  int refused = 0;
  while (plan_.goals.size() < 2) {
    const world::RoadCheckpoint* goal = goals_->at(planned_);
    if (goal == nullptr) return;
    ++planned_;
    if (extend(*corridors_, plan_, *goal)) continue;
    // By lot another one will do.
    if (!goals_->by_lot() || ++refused > 100) refuse(*goal);
  }
}

void Route::trim() {
  if (progress_.leg() < 2 * kOldLegs) return;
  const std::size_t gone = progress_.leg() - kOldLegs;
  plan_.legs.erase(plan_.legs.begin(), plan_.legs.begin() + static_cast<std::ptrdiff_t>(gone));
  progress_.set(progress_.s(), progress_.leg() - gone);
}

void Route::pass_goals(const Input& input) {
  if (!goals_) return;
  const double near = 0.06 * corridors_->body().radius;
  while (!plan_.goals.empty()) {
    const Goal& goal = plan_.goals.front();
    const bool last = plan_.goals.size() == 1 && goals_->at(planned_) == nullptr;
    const bool stands = std::abs(input.state.velocity.forward) < 0.01;
    const bool there = progress_.s() >= goal.s - (goal.park || last ? near : 0.0);
    if (!there || ((goal.park || last) && !stands)) return;
    plan_.goals.erase(plan_.goals.begin());
    ++next_goal_;
    if (last) done_ = true;
    fill();
  }
}

void Route::chase() {
  if (company_.leader == base::kNobody || (goals_ && company_.merges)) return;
  const auto row = row_of(right_of_way_.drivers(), company_.leader);
  const auto node = row ? heading_for(*corridors_, right_of_way_.drivers()[*row]) : std::nullopt;
  if (!node) return search();
  if (plan_.node == *node) return;
  goals_.reset();
  plan_.goals.clear();
  RoutePlan plan = plan_;
  cut_after(*corridors_, plan, progress_.s());
  const world::PointRef to = site_.roads->index[*node].second;
  if (plan.node == *node || extend(*corridors_, plan, to)) plan_ = std::move(plan);
}

// Who hears no leader drives on by lot, so that it stands in nobody's way, until it does.
void Route::search() {
  for (int tries = 0; tries < 10 && length_of(plan_) < progress_.s() + kLookAhead + 0.1; ++tries)
    if (const world::RoadCheckpoint* goal = lots_.at(searched_++)) extend(*corridors_, plan_, goal->at);
}

// A lane that stays full is gone round.
void Route::reroute(const Input& input) {
  const std::uint32_t avoid = blocked_way_;
  const std::int64_t patience = (20 + 2 * (site_.mover % 5)) * kSecond;
  if (blocked_since_ < 0 || input.time - blocked_since_ < patience || !goals_) return;
  blocked_since_ = input.time;
  if (corridors_->way(plan_.legs[progress_.leg()].way).kind != Way::Kind::lane) return;
  RoutePlan plan = plan_;
  cut_after(*corridors_, plan, progress_.s());
  if (plan_goals(plan, avoid)) plan_ = std::move(plan);
}

// On from the end of `plan` to what is still to come.
bool Route::plan_goals(RoutePlan& plan, std::uint32_t avoid) const {
  for (const Goal& goal : plan_.goals) {
    if (goal.s <= progress_.s()) continue;
    const auto* checkpoint = goal.id >= 0 ? find_checkpoint(*site_.roads, goal.id) : nullptr;
    if (checkpoint == nullptr || !extend(*corridors_, plan, *checkpoint, avoid)) return false;
  }
  return true;
}

// Two that change lanes against each other would wait for ever: who has stood for long goes back into its lane.
void Route::give_up_change(const Input& input) {
  if (std::abs(input.state.velocity.forward) > 0.005 || still_since_ < 0) still_since_ = input.time;
  const std::int64_t patience = (8 + 2 * (site_.mover % 5)) * kSecond;
  if (input.time - still_since_ < patience || company_.merges) return;
  const std::uint32_t row = plan_.legs[progress_.leg()].way;
  if (!changes_lanes(*corridors_, row)) return;
  auto plan = plan_back(*corridors_, plan_, progress_.s(), input.state.X_WM);
  if (!plan || !plan_goals(*plan, row)) return;
  plan_ = std::move(*plan);
  pass_until_ = -1.0;
  still_since_ = input.time;
}

void Route::consider_passing(const Input& input) {
  if (!settings_.pass || company_.leader != base::kNobody || progress_.s() < pass_until_) return;
  const bool behind = !ahead_.empty() && ahead_.front().free < 0.5 && ahead_.front().speed > 0.02 &&
                      ahead_.front().speed < 0.8 * settings_.speed;
  if (!behind) {
    slow_since_ = -1;
    return;
  }
  if (slow_since_ < 0) slow_since_ = input.time;
  if (input.time - slow_since_ < kSecond) return;
  auto passing =
      plan_passing(*corridors_, plan_, progress_.s(), settings_.speed, ahead_.front(), right_of_way_.drivers());
  if (!passing) return;
  plan_ = std::move(passing->plan);
  pass_until_ = passing->until;
  slow_since_ = -1;
}

// ---- A tick.

base::Twist Route::step(const Input& input) {
  if (!input.started) return {};
  if (!started_) start(input);
  const double dt = last_ < 0 ? 0.1 : std::clamp(1e-9 * static_cast<double>(input.time - last_), 0.01, 0.5);
  last_ = input.time;

  progress_.update(*corridors_, plan_, {input.state.X_WM.x, input.state.X_WM.y});
  pass_goals(input);
  right_of_way_.observe(input, company_.leader, company_.merges);
  chase();
  look_ahead(*corridors_, plan_, progress_.s(), right_of_way_.drivers(), ahead_);
  keep_company(company_, *corridors_, right_of_way_.drivers(), ahead_);
  consider_passing(input);
  reroute(input);
  give_up_change(input);
  trim();
  if (done_) return {};

  Limit limit{settings_.speed, dt};
  limit_by_bends(limit);
  limit_by_lines(input, limit);
  limit_by_gates(input, limit);
  limit_by_zones(limit, input);
  limit_by_others(limit);
  return drive(input, limit.speed);
}

base::Twist Route::drive(const Input& input, double speed) {
  const Pose& X_WM = input.state.X_WM;
  const RouteLeg& leg = plan_.legs[progress_.leg()];
  const Way& way = corridors_->way(leg.way);
  const double at = leg.from + progress_.s() - leg.start;
  const double yaw = yaw_on(way, at);
  offset_ = cross({std::cos(yaw), std::sin(yaw)}, Vec2{X_WM.x, X_WM.y} - point_on(way, at));
  const double heading = base::wrap_angle(X_WM.yaw + (way.backwards ? M_PI : 0.0) - yaw);
  // Behind a kink it turns on the spot until it looks along its way.
  const bool kink = progress_.leg() > 0 && kink_after(*corridors_, plan_, progress_.leg() - 1);
  const bool fresh = kink && at - leg.from < 0.25 * corridors_->body().radius;
  const double on_spot = !turns_in_place_ ? 10.0 : fresh ? 0.02 : 1.0;
  const double reach = 0.9 * corridors_->body().radius;
  // The bend half a step ahead is what the step will be driven in.
  base::Twist twist = steer(speed, offset_, heading, curvature_on(way, at + 0.05 * speed), reach, max_turn_, on_spot);
  if (way.backwards) twist.forward = -twist.forward;
  return twist;
}

// ---- From settings.

std::unique_ptr<Controller> make_route_controller(const Site& site, Settings& settings, bool convoy) {
  const world::Mover& mover = site.world.movers[site.mover];
  if (site.roads == nullptr)
    throw base::InputError(site.world.file, 0,
                           "it has no road network to drive on; expected road( rndf \"...\" ) in it");
  RouteSettings s;
  s.speed = settings.number("speed", std::min(convoy ? 0.25 : 0.2, mover.max_forward), 0.01, mover.max_forward);
  s.gap = settings.number("gap", convoy ? 0.2 : s.gap, 0.01, 100.0);
  s.headway = settings.number("headway", s.headway, 0.3, 10.0);
  s.pass = settings.flag("pass", true);
  s.radio = settings.number("radio", convoy ? 12.0 : s.radio, 0.5, 1e6);
  Company company;
  if (convoy) {
    if (!settings.has("leader"))
      settings.refuse("leader", "a convoy needs 'leader', the number of the robot to follow");
    company.leader = static_cast<std::uint32_t>(settings.number("leader", 0, 0, 4294967294.0));
  } else if (settings.has("merge_behind")) {
    company = {static_cast<std::uint32_t>(settings.number("merge_behind", 0, 0, 4294967294.0)), true};
  }
  std::optional<RouteGoals> goals;
  if (!convoy) goals.emplace(site, settings);
  auto corridors = shared_corridors(*site.roads, site.world, body_of(mover));
  return std::make_unique<Route>(std::move(corridors), site, s, std::move(goals), company);
}

namespace {

std::unique_ptr<Controller> make_route(const Site& site, Settings& settings) {
  return make_route_controller(site, settings, false);
}

}  // namespace

constinit const ControllerKind route_controller{
    .name = "route",
    .summary = "drives over the roads from checkpoint to checkpoint, minding stop lines, lights and others",
    .rate = 10.0,
    .waits = true,
    .make = make_route,
};

}  // namespace sf::control
