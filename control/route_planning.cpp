// Planning of a route: to its goals, behind a leader, around full lanes, past slower robots.

#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "base/time.h"
#include "control/overtaking.h"
#include "control/route.h"

namespace sf::control {

namespace {

constexpr std::size_t kOldLegs = 24;  // number of passed legs that are kept

}  // namespace

void Route::start(const ControllerInput& input) {
  const Pose& X_WM = input.state.X_WM;
  if (const auto spot = spot_at(*corridors_, X_WM)) {
    plan_ = plan_from_spot(*corridors_, *spot);
  } else {
    const auto place = locate_on_road(*corridors_, X_WM);
    if (!place)
      throw base::InputError(
          fmt::format("robot '{}' is at ({:.2f}, {:.2f}){}, where no lane of '{}' runs in its direction; place it on a "
                      "lane or in a parking spot",
                      site_.world.movers[site_.mover].name, X_WM.x, X_WM.y,
                      site_.world.ramps.empty() ? "" : fmt::format(" and z = {:.2f}", X_WM.z), site_.roads->file));
    plan_ = plan_from(*corridors_, *place);
  }
  started_ = true;
  if (!roads_) check_goals();
  fill();
}

// Plans a list of goals once to its end and back to its start, to detect unreachable goals before driving.
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
      "robot '{}' has no route to checkpoint {} (way-point {}) in '{}'; choose other checkpoints, or add exits",
      site_.world.movers[site_.mover].name, goal.id, point_id_text(id_of(*site_.roads, goal.at)), site_.roads->file));
}

// Plans two goals ahead, so that the route continues beyond the next goal. Where lanes were closed, the robot waits at
// the end of its route until they open.
void Route::fill() {
  if (!goals_) return;
  unreachable_ = false;
  int refused = 0;
  while (plan_.goals.size() < 2) {
    const world::RoadCheckpoint* goal = goals_->at(planned_);
    if (goal == nullptr) return;
    ++planned_;
    if (extend(*corridors_, plan_, here(*goal))) continue;
    // Skips a random goal without a path.
    if (goals_->by_lot() && ++refused <= 100) continue;
    if (!roads_) refuse(*goal);
    --planned_;
    unreachable_ = true;
    return;
  }
}

/// Returns the goal in the current network, where a reversed lane has its points in the opposite order.
world::RoadCheckpoint Route::here(const world::RoadCheckpoint& goal) const {
  const auto* checkpoint = goal.id >= 0 ? find_checkpoint(corridors_->roads(), goal.id) : nullptr;
  return checkpoint != nullptr ? *checkpoint : goal;
}

// Continues on the way it is on, and on the next if it can no longer stop before it, and replans from there. A robot on
// a way that no longer exists finishes it first.
void Route::adopt(const ControllerInput& input) {
  if (!input.roads || input.roads == roads_) return;
  auto corridors = shared_lane_corridors(*input.roads, site_.world, corridors_->body());
  if (started_ && !done_) {
    RoutePlan plan = plan_;
    const double v = input.state.velocity.forward;
    const double s = progress_.s() + v * v / (2.0 * kHardBraking) + 0.15 * corridors_->body().radius;
    cut_after(*corridors_, plan, s);
    const auto passed = moved_to(*corridors_, *corridors, plan, progress_.leg());
    if (!passed) return;
    planned_ -= plan_.goals.size() - plan.goals.size();
    plan_ = std::move(plan);
    progress_.set(progress_.s(), progress_.leg() - *passed);
  }
  corridors_ = std::move(corridors);
  roads_ = input.roads;
  right_of_way_.use(*corridors_);
  blocked_way_ = world::kNone;
  blocked_since_ = -1;
  pass_until_ = -1.0;
  if (started_ && !done_) fill();
}

void Route::trim() {
  if (progress_.leg() < 2 * kOldLegs) return;
  const std::size_t gone = progress_.leg() - kOldLegs;
  plan_.legs.erase(plan_.legs.begin(), plan_.legs.begin() + static_cast<std::ptrdiff_t>(gone));
  progress_.set(progress_.s(), progress_.leg() - gone);
}

void Route::pass_goals(const ControllerInput& input) {
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

void Route::follow_leader() {
  if (convoy_.leader == base::kNoId || (goals_ && convoy_.merges)) return;
  const auto row = row_of(right_of_way_.road_users(), convoy_.leader);
  const auto node = row ? heading_for(*corridors_, right_of_way_.road_users()[*row]) : std::nullopt;
  if (!node) return search();
  if (plan_.node == *node) return;
  goals_.reset();
  plan_.goals.clear();
  RoutePlan plan = plan_;
  cut_after(*corridors_, plan, progress_.s());
  const world::PointRef to = corridors_->roads().index[*node].second;
  if (plan.node == *node || extend(*corridors_, plan, to)) plan_ = std::move(plan);
}

// Without a leader in range the robot drives to random goals, so that it does not block others.
void Route::search() {
  for (int tries = 0; tries < 10 && length_of(plan_) < progress_.s() + kLookaheadDistance + 0.1; ++tries)
    if (const world::RoadCheckpoint* goal = lots_.at(searched_++)) extend(*corridors_, plan_, here(*goal).at);
}

// Avoids a lane that stays full.
void Route::reroute(const ControllerInput& input) {
  const std::uint32_t avoid = blocked_way_;
  const std::int64_t patience = (20 + 2 * (site_.row_in_copy() % 5)) * base::kSecond;
  if (blocked_since_ < 0 || input.time - blocked_since_ < patience || !goals_) return;
  blocked_since_ = input.time;
  if (corridors_->way(plan_.legs[progress_.leg()].way).kind != Way::Kind::lane) return;
  RoutePlan plan = plan_;
  cut_after(*corridors_, plan, progress_.s());
  if (plan_goals(plan, avoid)) plan_ = std::move(plan);
}

// Extends `plan` to the remaining goals.
bool Route::plan_goals(RoutePlan& plan, std::uint32_t avoid) const {
  for (const Goal& goal : plan_.goals) {
    if (goal.s <= progress_.s()) continue;
    const auto* checkpoint = goal.id >= 0 ? find_checkpoint(corridors_->roads(), goal.id) : nullptr;
    if (checkpoint == nullptr || !extend(*corridors_, plan, *checkpoint, avoid)) return false;
  }
  return true;
}

// Two robots that swap lanes could block each other forever. After a long standstill one of them returns to its lane.
void Route::give_up_change(const ControllerInput& input) {
  if (std::abs(input.state.velocity.forward) > 0.005 || still_since_ < 0) still_since_ = input.time;
  const std::int64_t patience = (8 + 2 * (site_.row_in_copy() % 5)) * base::kSecond;
  if (input.time - still_since_ < patience || convoy_.merges) return;
  const std::uint32_t row = plan_.legs[progress_.leg()].way;
  if (!changes_lanes(*corridors_, row)) return;
  auto plan = plan_return(*corridors_, plan_, progress_.s(), input.state.X_WM);
  if (!plan || !plan_goals(*plan, row)) return;
  plan_ = std::move(*plan);
  pass_until_ = -1.0;
  still_since_ = input.time;
}

void Route::consider_passing(const ControllerInput& input) {
  if (!settings_.pass || convoy_.leader != base::kNoId || progress_.s() < pass_until_) return;
  const bool behind = !ahead_.empty() && ahead_.front().free < 0.5 && ahead_.front().speed > 0.02 &&
                      ahead_.front().speed < 0.8 * settings_.speed;
  if (!behind) {
    slow_since_ = -1;
    return;
  }
  if (slow_since_ < 0) slow_since_ = input.time;
  if (input.time - slow_since_ < base::kSecond) return;
  auto passing =
      plan_passing(*corridors_, plan_, progress_.s(), settings_.speed, ahead_.front(), right_of_way_.road_users());
  if (!passing) return;
  plan_ = std::move(passing->plan);
  pass_until_ = passing->until;
  slow_since_ = -1;
}

}  // namespace sf::control
