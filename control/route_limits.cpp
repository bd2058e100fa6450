// Speed limits of a robot on its route.

#include <algorithm>
#include <cmath>

#include "control/route.h"

namespace sf::control {

namespace {

constexpr double kBraking = 0.3;             // [m/s^2] comfortable deceleration
constexpr double kSideways = 0.1;            // [m/s^2] lateral acceleration in curves
constexpr double kWaiting = 0.5;             // factor of the speed while a follower has fallen behind
constexpr double kStandstill = 0.02;         // [m/s] below this speed a robot counts as stopped
constexpr std::int64_t kStop = 300'000'000;  // [ns] duration of a full stop

}  // namespace

void Route::Limit::stop_in(double distance, const char* reason) {
  const double v = distance <= 0.001 ? 0.0 : std::min(std::sqrt(2.0 * kBraking * distance), distance / dt);
  if (v >= speed) return;
  speed = v;
  why = reason;
  who = base::kNoId;
}

void Route::limit_by_curvature(Limit& limit) const {
  const double step = 0.5 * corridors_->body().radius;
  const double s = progress_.s();
  std::size_t leg = progress_.leg();
  for (double ahead = 0.0; ahead <= 4.0 * step; ahead += step) {
    const OnRoute here = on_route(*corridors_, plan_, s + ahead, leg);
    leg = here.leg;
    const double bend = std::max(std::abs(here.curvature), 1e-9);
    const double slow = std::max(std::min(std::sqrt(kSideways / bend), 0.7 * max_turn_ / bend), 0.25 * limit.speed);
    limit.speed = std::min(limit.speed, std::sqrt(slow * slow + 2.0 * kBraking * ahead));
  }
  const Way& way = corridors_->way(plan_.legs[progress_.leg()].way);
  if (goals_ && way.kind == Way::Kind::lane)
    limit.speed = std::min(limit.speed, goals_->limit(site_.roads->lanes[plan_.legs[progress_.leg()].way].segment));
  if (way.kind == Way::Kind::zone) limit.speed = std::min(limit.speed, 0.5 * settings_.speed);
}

void Route::limit_by_lines(const ControllerInput& input, Limit& limit) {
  const double margin = 0.12 * corridors_->body().radius;
  const double speed = std::abs(input.state.velocity.forward);
  for (std::size_t i = progress_.leg(); i < plan_.legs.size(); ++i) {
    const RouteLeg& leg = plan_.legs[i];
    if (leg.start > progress_.s() + 1.5) return;
    for (const LaneStop& mark : corridors_->way(leg.way).stops) {
      if (mark.s <= leg.from || mark.s > leg.to + 1e-9) continue;
      const double line = leg.start + mark.s - leg.from;
      const double ahead = line - corridors_->body().front - margin - progress_.s();
      if (ahead < -margin) continue;  // the robot is beyond the line
      const Rule rule = rule_of(mark, input.signals);
      const bool yellow = rule == Rule::closed && input.signals[mark.lights.front()].state == world::LightState::yellow;
      if (rule == Rule::closed && (!yellow || !right_of_way_.committed(ahead, speed)))
        return limit.stop_in(ahead, yellow ? "its light is yellow" : "its light is red");
      if (rule != Rule::stop || stopped_at_ == line) continue;
      limit.stop_in(ahead, "it stops at a stop line");
      if (speed > 0.005 || ahead > 0.3 * corridors_->body().radius) {
        standing_since_ = -1;
        return;
      }
      if (standing_since_ < 0) standing_since_ = input.time;
      if (input.time - standing_since_ >= kStop) {
        stopped_at_ = line;
        standing_since_ = -1;
      }
      return;
    }
  }
}

void Route::limit_by_conflict_zones(const ControllerInput& input, Limit& limit) {
  const double speed = std::abs(input.state.velocity.forward);
  bool full = false;
  for (std::size_t i = progress_.leg(); i < plan_.legs.size(); ++i) {
    const RouteLeg& leg = plan_.legs[i];
    if (leg.start > progress_.s() + kApproachDistance + 0.5) break;
    for (const ConflictZone& conflict_zone : corridors_->way(leg.way).conflict_zones) {
      if (conflict_zone.end <= leg.from || conflict_zone.hold >= leg.to) continue;
      const double ahead = leg.start + conflict_zone.hold - leg.from - progress_.s();
      const double end = leg.start + conflict_zone.end - leg.from;
      if (ahead > kApproachDistance || end <= progress_.s() || right_of_way_.committed(ahead, speed)) continue;
      const bool room = room_beyond(end);
      if (room && right_of_way_.may_enter(leg.way, conflict_zone)) continue;
      limit.stop_in(std::max(ahead, 0.0),
                    room ? "others have the right of way where routes cross" : "the lane ahead is full");
      if (!room && speed < 0.01 && ahead < 0.3) {
        full = true;
        if (blocked_way_ != leg.way) blocked_since_ = -1;
        blocked_way_ = leg.way;
      }
    }
  }
  if (!full) blocked_since_ = -1;
  if (full && blocked_since_ < 0) blocked_since_ = input.time;
}

/// Returns whether all robots ahead of `end`, and this robot, have room between `end` and the first robot beyond it.
bool Route::room_beyond(double end) const {
  const double room = end - progress_.s();
  double between = 0.0;
  for (const LeadRobot& other : ahead_) {
    if (other.free < room) {
      if (other.speed < 0.02) return false;  // it has stopped, possibly for a long time
      between += 2.2 * corridors_->body().radius + settings_.gap;
      continue;
    }
    return other.free - settings_.gap - between >= room;
  }
  return true;
}

// Only one robot at a time drives in a zone. The others wait before the zone or in their spots.
void Route::limit_by_zones(Limit& limit, const ControllerInput& input) {
  const double s = progress_.s();
  const double margin = 0.12 * corridors_->body().radius;
  for (std::size_t i = progress_.leg(); i < plan_.legs.size() && plan_.legs[i].start <= s + 1.0; ++i) {
    const RouteLeg& leg = plan_.legs[i];
    const Way& way = corridors_->way(leg.way);
    if (way.backwards && s - leg.start < margin) {
      // Parked robots leave in turn.
      const std::uint32_t spots = site_.roads->zones[way.zone].spots;
      const auto turn = static_cast<std::uint64_t>(input.time / 2'000'000'000) % spots;
      const auto own = spot_at(*corridors_, input.state.X_WM).value_or(0) - site_.roads->zones[way.zone].first_spot;
      if (turn != own || !right_of_way_.zone_free(way.zone))
        limit.stop_in(std::max(leg.start - s, 0.0), "it waits for its turn to leave its parking spot");
    }
    if (way.in_zone && way.from != world::kNone) {
      const double ahead = leg.start - corridors_->body().front - margin - s;
      if (!right_of_way_.committed(ahead, std::abs(input.state.velocity.forward)) && !right_of_way_.zone_free(way.zone))
        limit.stop_in(std::max(ahead, 0.0), "another robot is driving in the zone");
    }
    if (cusp_after(*corridors_, plan_, i)) {
      limit.stop_in(std::max(end_of(leg) - s, 0.0),
                    unreachable_ ? "no open lane leads to its checkpoint" : "its route ends");
      break;
    }
  }
  for (const Goal& goal : plan_.goals) {
    const bool last = goals_ && &goal == &plan_.goals.back() && goals_->at(planned_) == nullptr;
    if (goal.park || last) return limit.stop_in(std::max(goal.s - s, 0.0), "it is at its goal");
  }
}

// Keeps the gap, plus a distance proportional to the speed.
void Route::limit_by_others(Limit& limit) const {
  if (follower_lags(right_of_way_.road_users())) limit.speed = std::min(limit.speed, kWaiting * settings_.speed);
  const double opened = opened_gap(convoy_, *corridors_, right_of_way_.road_users());
  for (const LeadRobot& other : ahead_) {
    const bool leads = right_of_way_.road_users()[other.row].id == convoy_.leader;
    const double free = other.free - settings_.gap - (leads ? opened : 0.0);
    const double most = free > 1e-3 ? free / settings_.headway : 0.0;
    if (most >= limit.speed) continue;
    limit.speed = most;
    limit.why = std::abs(other.speed) < kStandstill ? "blocks its way" : "is in its way";
    limit.who = right_of_way_.road_users()[other.row].id;
  }
}

}  // namespace sf::control
