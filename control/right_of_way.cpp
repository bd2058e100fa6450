#include "control/right_of_way.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "base/random.h"

namespace sf::control {

namespace {

constexpr double kSensingRange = 3.5;  // [m]
constexpr double kStanding = 0.01;     // [m/s]

std::uint32_t lot(std::uint32_t id, std::int64_t turn) {
  return base::random_words(
      {.stream = base::RandomStream::decision, .a = id, .b = 0x6C6F74u, .c = static_cast<std::uint64_t>(turn)}, 0)[0];
}

}  // namespace

Rule rule_of(const LaneStop& mark, std::span<const world::Signal> signals) {
  if (mark.lights.empty() || mark.lights.front() >= signals.size()) return Rule::stop;
  switch (signals[mark.lights.front()].state) {
    case world::LightState::green:
    case world::LightState::flashing_yellow:
      return Rule::free;
    case world::LightState::red:
    case world::LightState::yellow:
      return Rule::closed;
    case world::LightState::flashing_red:
    case world::LightState::dark:
      break;
  }
  return Rule::stop;
}

RightOfWay::RightOfWay(const LaneCorridors& corridors, std::uint32_t own_id)
    : corridors_(&corridors), own_id_(own_id), margin_(0.15 * corridors.body().radius) {}

void RightOfWay::use(const LaneCorridors& corridors) {
  corridors_ = &corridors;
  known_.clear();
  road_users_.clear();
}

bool RightOfWay::committed(double ahead, double speed) const {
  return ahead + margin_ < speed * speed / (2.0 * kHardBraking);
}

// Positions are recomputed only after a robot has moved.
const RoadPositions& RightOfWay::positions_of(std::uint32_t id, const Pose& X_WM) {
  auto known = std::find_if(known_.begin(), known_.end(), [&](const Known& k) { return k.id == id; });
  if (known == known_.end()) known = known_.insert(known_.end(), {id, {HUGE_VAL, 0.0, 0.0, 0.0}, {}, 0});
  known->seen = time_;
  if (known->X_WM.x == X_WM.x && known->X_WM.y == X_WM.y && known->X_WM.yaw == X_WM.yaw) return known->positions;
  known->X_WM = X_WM;
  RoadPositions& positions = known->positions;
  positions = corridors_->positions(X_WM, 0.8 * corridors_->body().radius);
  // Keeps the ways that are about as near as the nearest one.
  const double most = positions.count > 0 ? positions.all[0].offset + 0.25 * corridors_->body().radius : 0.0;
  while (positions.count > 1 && positions.all[positions.count - 1].offset > most) --positions.count;
  return positions;
}

void RightOfWay::add(std::uint32_t id, const base::Report& state, std::uint32_t follows) {
  RoadUser driver{.id = id, .follows = follows, .X_WM = state.X_WM, .approach = {}};
  driver.velocity = base::rotate(state.X_WM.yaw, {state.velocity.forward, state.velocity.left});
  driver.speed = length(driver.velocity);
  driver.positions = positions_of(id, state.X_WM);
  road_users_.push_back(driver);
}

void RightOfWay::observe(const ControllerInput& input, std::uint32_t follows, bool merges) {
  time_ = input.time;
  merges_ = merges;
  road_users_.clear();
  add(own_id_, input.state, follows);
  const Pose& here = input.state.X_WM;
  for (const Neighbour& other : input.others) {
    const Pose& there = other.state.X_WM;
    const bool near = base::hypot(there.x - here.x, there.y - here.y) <= kSensingRange;
    const bool convoy = other.id == follows || other.intent.follows == own_id_;
    if (other.id == own_id_ || (!near && !convoy)) continue;
    add(other.id, other.state, other.intent.follows);
  }
  for (RoadUser& driver : road_users_) find_approach(driver, input.signals);
  for (RoadUser& driver : road_users_) remember(driver, input.time);
  std::erase_if(known_, [&](const Known& known) { return known.seen != time_; });
  std::erase_if(arrivals_, [&](const Arrival& arrival) { return arrival.seen != time_; });
}

void RightOfWay::find_approach(RoadUser& driver, std::span<const world::Signal> signals) const {
  for (const RoadPosition& place : driver.positions) {
    const Way& lane = corridors_->way(place.way);
    if (lane.kind != Way::Kind::lane || lane.lines.empty()) continue;
    const auto next = std::lower_bound(lane.lines.begin(), lane.lines.end(), place.s - 0.03);
    Approach& approach = driver.approach;
    approach = {.lane = place.way, .line = next == lane.lines.end() ? lane.lines.back() : *next};
    approach.ahead = approach.line - place.s;
    if (approach.ahead > kApproachDistance) return;  // too far to matter
    for (const LaneStop& mark : lane.stops)
      if (std::abs(mark.s - corridors_->body().front - approach.line) < corridors_->body().radius)
        approach.rule = rule_of(mark, signals);
    approach.first = std::none_of(road_users_.begin(), road_users_.end(), [&](const RoadUser& other) {
      if (&other == &driver) return false;
      return std::any_of(other.positions.begin(), other.positions.end(), [&](const RoadPosition& p) {
        return p.way == place.way && p.s > place.s && p.s <= approach.line + margin_;
      });
    });
    return;
  }
}

void RightOfWay::remember(RoadUser& driver, std::int64_t time) {
  Approach& approach = driver.approach;
  if (approach.lane == world::kNone || !approach.first || approach.ahead > kApproachDistance) return;
  auto known = std::find_if(arrivals_.begin(), arrivals_.end(), [&](const Arrival& arrival) {
    return arrival.id == driver.id && arrival.lane == approach.lane && arrival.line == approach.line;
  });
  if (known == arrivals_.end())
    known = arrivals_.insert(arrivals_.end(), {driver.id, approach.lane, approach.line, time, time, false, false});
  Arrival& arrival = *known;
  arrival.seen = time;
  const bool stands = driver.speed < kStanding && std::abs(approach.ahead) < 0.5 * corridors_->body().radius;
  arrival.stood = arrival.stood || stands;
  const bool contends = approach.rule == Rule::free || (approach.rule == Rule::stop && arrival.stood);
  if (contends && !arrival.contends) arrival.since = time;
  arrival.contends = contends;
  approach.contends = contends;
  approach.since = arrival.since;
}

bool RightOfWay::precedes(const RoadUser& other, const Approach& own) const {
  const RoadUser& self = road_users_.front();
  if (self.follows != base::kNoId) {
    if (other.id == self.follows) return true;
    if (other.follows == self.follows) return !merges_;
  }
  if (other.follows == self.id) return false;
  if (own.lane == world::kNone) return true;
  const Approach& theirs = other.approach;
  if (time_ - own.since > kMaxWait || time_ - theirs.since > kMaxWait) {
    const std::int64_t turn = time_ / kLotteryPeriod;
    const std::uint32_t mine = lot(self.id, turn), others = lot(other.id, turn);
    return others != mine ? others < mine : other.id < self.id;
  }
  if (theirs.rule != own.rule) return theirs.rule < own.rule;
  return theirs.since != own.since ? theirs.since < own.since : other.id < self.id;
}

bool RightOfWay::is_in_way(const RoadUser& other, const Conflict& conflict, const Approach& own) const {
  const Way& way = corridors_->way(conflict.way);
  const Approach& theirs = other.approach;
  // A merging robot yields to its leader, at any distance.
  const bool leads = merges_ && other.id == road_users_.front().follows;
  for (const RoadPosition& place : other.positions) {
    if (leads && place.way == (way.kind == Way::Kind::lane ? conflict.way : way.from) &&
        (way.kind != Way::Kind::lane || place.s < conflict.other_from))
      return true;
    if (place.way != conflict.way || place.s >= conflict.other_to) continue;
    if (way.kind != Way::Kind::lane) {
      if (way.at_end || place.s > conflict.other_from - margin_) return true;
      continue;
    }
    // A robot on the lane that this way enters has priority if it arrives there soon.
    if (conflict.yields) {
      // If two stopped robots want to swap lanes, the one with the smaller id begins.
      if (other.speed < kStanding && road_users_.front().id < other.id) continue;
      // A robot that drives on ahead is followed.
      const double body = 2.5 * corridors_->body().radius;
      if (place.s > conflict.other_from + body && other.speed > kStanding) continue;
      // The other follower of the same leader opens a gap for a merging robot. It blocks only the way next to that gap.
      const bool lets_in = merges_ && other.follows == road_users_.front().follows;
      if (lets_in && place.s < conflict.other_from - body) continue;
      if (place.s > conflict.other_from - 2.0 * corridors_->body().radius - 2.5 * other.speed) return true;
      continue;
    }
    for (const ConflictZone& conflict_zone : way.conflict_zones) {
      if (conflict_zone.end < conflict.other_to || conflict_zone.hold > conflict.other_from) continue;
      if (committed(conflict_zone.hold - place.s, other.speed)) return true;
      if (theirs.lane == conflict.way && theirs.line == conflict_zone.hold && theirs.contends && precedes(other, own))
        return true;
    }
  }
  if (!way.at_end || theirs.lane != way.from || way.conflict_zones.empty()) return false;
  if (theirs.line != way.leave + way.conflict_zones.front().hold) return false;
  if (committed(theirs.ahead, other.speed)) return true;
  return theirs.contends && precedes(other, own);
}

bool RightOfWay::may_enter(std::uint32_t row, const ConflictZone& conflict_zone) const {
  const Way& way = corridors_->way(row);
  const RoadUser& self = road_users_.front();
  // A robot before a line of a lane has to contend; a lane change has no such line.
  Approach own = self.approach;
  const bool has_line = way.kind == Way::Kind::lane || way.at_end;
  if (has_line && !own.contends) return false;
  if (!has_line) own.lane = world::kNone;
  for (const Conflict& conflict : conflict_zone.conflicts)
    for (std::size_t i = 1; i < road_users_.size(); ++i)
      if (is_in_way(road_users_[i], conflict, own)) return false;
  return true;
}

bool RightOfWay::zone_free(std::uint32_t zone) const {
  const auto parked = [&](const RoadUser& driver) {
    const auto& roads = corridors_->roads();
    const world::RoadZone& z = roads.zones[zone];
    for (std::uint32_t spot = z.first_spot; spot < z.first_spot + z.spots; ++spot) {
      const Pose at = corridors_->parked(spot);
      const glm::dvec2 d{driver.X_WM.x - at.x, driver.X_WM.y - at.y};
      if (length(d) < 0.35 * corridors_->body().radius && driver.speed < kStanding) return true;
    }
    return false;
  };
  for (std::size_t i = 1; i < road_users_.size(); ++i) {
    const RoadUser& driver = road_users_[i];
    if (corridors_->inside(zone, {driver.X_WM.x, driver.X_WM.y}) && !parked(driver)) return false;
    for (const RoadPosition& place : driver.positions) {
      const Way& way = corridors_->way(place.way);
      if (way.zone == zone && way.kind == Way::Kind::exit) return false;
      if (way.kind != Way::Kind::lane || place.s < way.length - corridors_->body().front) continue;
      for (const std::uint32_t out : way.out)
        if (corridors_->way(out).zone == zone && corridors_->way(out).leave >= place.s) return false;
    }
  }
  return true;
}

}  // namespace sf::control
