#include "control/right_of_way.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"

namespace sf::control {

namespace {

constexpr double kSight = 3.5;      // [m]
constexpr double kStanding = 0.01;  // [m/s]

std::uint32_t lot(std::uint32_t id, std::int64_t turn) {
  return base::random_words(
      {.stream = base::RandomStream::decision, .a = id, .b = 0x6C6F74u, .c = static_cast<std::uint64_t>(turn)}, 0)[0];
}

}  // namespace

Rule rule_of(const StopMark& mark, std::span<const world::Signal> signals) {
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

RightOfWay::RightOfWay(const Corridors& corridors, std::uint32_t own_id)
    : corridors_(corridors), own_id_(own_id), margin_(0.15 * corridors.body().radius) {}

bool RightOfWay::committed(double ahead, double speed) const {
  return ahead + margin_ < speed * speed / (2.0 * kHardBraking);
}

// Who has not moved is where it was.
const Places& RightOfWay::places_of(std::uint32_t id, const Pose& X_WM) {
  auto known = std::find_if(known_.begin(), known_.end(), [&](const Known& k) { return k.id == id; });
  if (known == known_.end()) known = known_.insert(known_.end(), {id, {HUGE_VAL, 0.0, 0.0, 0.0}, {}, 0});
  known->seen = time_;
  if (known->X_WM.x == X_WM.x && known->X_WM.y == X_WM.y && known->X_WM.yaw == X_WM.yaw) return known->places;
  known->X_WM = X_WM;
  Places& places = known->places;
  places = corridors_.places(X_WM, 0.8 * corridors_.body().radius);
  // Only those that are about as near as the nearest.
  const double most = places.count > 0 ? places.all[0].offset + 0.25 * corridors_.body().radius : 0.0;
  while (places.count > 1 && places.all[places.count - 1].offset > most) --places.count;
  return places;
}

void RightOfWay::add(std::uint32_t id, const base::Report& state, std::uint32_t follows) {
  Driver driver{.id = id, .follows = follows, .X_WM = state.X_WM, .approach = {}};
  driver.velocity = base::rotate(state.X_WM.yaw, {state.velocity.forward, state.velocity.left});
  driver.speed = length(driver.velocity);
  driver.places = places_of(id, state.X_WM);
  drivers_.push_back(driver);
}

void RightOfWay::observe(const Input& input, std::uint32_t follows, bool merges) {
  time_ = input.time;
  merges_ = merges;
  drivers_.clear();
  add(own_id_, input.state, follows);
  const Pose& here = input.state.X_WM;
  for (const Neighbour& other : input.others) {
    const Pose& there = other.state.X_WM;
    const bool near = std::hypot(there.x - here.x, there.y - here.y) <= kSight;
    const bool company = other.id == follows || other.intent.follows == own_id_;
    if (other.id == own_id_ || (!near && !company)) continue;
    add(other.id, other.state, other.intent.follows);
  }
  for (Driver& driver : drivers_) find_approach(driver, input.signals);
  for (Driver& driver : drivers_) remember(driver, input.time);
  std::erase_if(known_, [&](const Known& known) { return known.seen != time_; });
  std::erase_if(arrivals_, [&](const Arrival& arrival) { return arrival.seen != time_; });
}

void RightOfWay::find_approach(Driver& driver, std::span<const world::Signal> signals) const {
  for (const Place& place : driver.places) {
    const Way& lane = corridors_.way(place.way);
    if (lane.kind != Way::Kind::lane || lane.lines.empty()) continue;
    const auto next = std::lower_bound(lane.lines.begin(), lane.lines.end(), place.s - 0.03);
    Approach& approach = driver.approach;
    approach = {.lane = place.way, .line = next == lane.lines.end() ? lane.lines.back() : *next};
    approach.ahead = approach.line - place.s;
    if (approach.ahead > kApproach) return;  // too far to matter
    for (const StopMark& mark : lane.stops)
      if (std::abs(mark.s - corridors_.body().front - approach.line) < corridors_.body().radius)
        approach.rule = rule_of(mark, signals);
    approach.first = std::none_of(drivers_.begin(), drivers_.end(), [&](const Driver& other) {
      if (&other == &driver) return false;
      return std::any_of(other.places.begin(), other.places.end(), [&](const Place& p) {
        return p.way == place.way && p.s > place.s && p.s <= approach.line + margin_;
      });
    });
    return;
  }
}

void RightOfWay::remember(Driver& driver, std::int64_t time) {
  Approach& approach = driver.approach;
  if (approach.lane == world::kNone || !approach.first || approach.ahead > kApproach) return;
  auto known = std::find_if(arrivals_.begin(), arrivals_.end(), [&](const Arrival& arrival) {
    return arrival.id == driver.id && arrival.lane == approach.lane && arrival.line == approach.line;
  });
  if (known == arrivals_.end())
    known = arrivals_.insert(arrivals_.end(), {driver.id, approach.lane, approach.line, time, time, false, false});
  Arrival& arrival = *known;
  arrival.seen = time;
  const bool stands = driver.speed < kStanding && std::abs(approach.ahead) < 0.5 * corridors_.body().radius;
  arrival.stood = arrival.stood || stands;
  const bool contends = approach.rule == Rule::free || (approach.rule == Rule::stop && arrival.stood);
  if (contends && !arrival.contends) arrival.since = time;
  arrival.contends = contends;
  approach.contends = contends;
  approach.since = arrival.since;
}

bool RightOfWay::precedes(const Driver& other, const Approach& own) const {
  const Driver& self = drivers_.front();
  if (self.follows != base::kNoId) {
    if (other.id == self.follows) return true;
    if (other.follows == self.follows) return !merges_;
  }
  if (other.follows == self.id) return false;
  if (own.lane == world::kNone) return true;
  const Approach& theirs = other.approach;
  if (time_ - own.since > kPatience || time_ - theirs.since > kPatience) {
    const std::int64_t turn = time_ / kTurn;
    const std::uint32_t mine = lot(self.id, turn), others = lot(other.id, turn);
    return others != mine ? others < mine : other.id < self.id;
  }
  if (theirs.rule != own.rule) return theirs.rule < own.rule;
  return theirs.since != own.since ? theirs.since < own.since : other.id < self.id;
}

bool RightOfWay::is_in_way(const Driver& other, const Meeting& meeting, const Approach& own) const {
  const Way& way = corridors_.way(meeting.way);
  const Approach& theirs = other.approach;
  // Who is to come in behind another lets that one pass first, however far off it is.
  const bool leads = merges_ && other.id == drivers_.front().follows;
  for (const Place& place : other.places) {
    if (leads && place.way == (way.kind == Way::Kind::lane ? meeting.way : way.from) &&
        (way.kind != Way::Kind::lane || place.s < meeting.other_from))
      return true;
    if (place.way != meeting.way || place.s >= meeting.other_to) continue;
    if (way.kind != Way::Kind::lane) {
      if (way.at_end || place.s > meeting.other_from - margin_) return true;
      continue;
    }
    // Who is on the lane that this way comes into goes first, in time to pass.
    if (meeting.yields) {
      // Of two that stand abreast and want to change places, one has to begin.
      if (other.speed < kStanding && drivers_.front().id < other.id) continue;
      // Who drives on ahead is followed.
      const double body = 2.5 * corridors_.body().radius;
      if (place.s > meeting.other_from + body && other.speed > kStanding) continue;
      // Who follows the same leader opens a gap for who merges, and that has to be there.
      const bool lets_in = merges_ && other.follows == drivers_.front().follows;
      if (lets_in && place.s < meeting.other_from - body) continue;
      if (place.s > meeting.other_from - 2.0 * corridors_.body().radius - 2.5 * other.speed) return true;
      continue;
    }
    for (const Gate& gate : way.gates) {
      if (gate.end < meeting.other_to || gate.hold > meeting.other_from) continue;
      if (committed(gate.hold - place.s, other.speed)) return true;
      if (theirs.lane == meeting.way && theirs.line == gate.hold && theirs.contends && precedes(other, own))
        return true;
    }
  }
  if (!way.at_end || theirs.lane != way.from || way.gates.empty()) return false;
  if (theirs.line != way.leave + way.gates.front().hold) return false;
  if (committed(theirs.ahead, other.speed)) return true;
  return theirs.contends && precedes(other, own);
}

bool RightOfWay::may_enter(std::uint32_t row, const Gate& gate) const {
  const Way& way = corridors_.way(row);
  const Driver& self = drivers_.front();
  // Before a line of a lane it has to contend itself; a change of lanes has no such line.
  Approach own = self.approach;
  const bool has_line = way.kind == Way::Kind::lane || way.at_end;
  if (has_line && !own.contends) return false;
  if (!has_line) own.lane = world::kNone;
  for (const Meeting& meeting : gate.meetings)
    for (std::size_t i = 1; i < drivers_.size(); ++i)
      if (is_in_way(drivers_[i], meeting, own)) return false;
  return true;
}

bool RightOfWay::zone_free(std::uint32_t zone) const {
  const auto parked = [&](const Driver& driver) {
    const auto& roads = corridors_.roads();
    const world::RoadZone& z = roads.zones[zone];
    for (std::uint32_t spot = z.first_spot; spot < z.first_spot + z.spots; ++spot) {
      const Pose at = corridors_.parked(spot);
      const glm::dvec2 d{driver.X_WM.x - at.x, driver.X_WM.y - at.y};
      if (length(d) < 0.35 * corridors_.body().radius && driver.speed < kStanding) return true;
    }
    return false;
  };
  for (std::size_t i = 1; i < drivers_.size(); ++i) {
    const Driver& driver = drivers_[i];
    if (corridors_.inside(zone, {driver.X_WM.x, driver.X_WM.y}) && !parked(driver)) return false;
    for (const Place& place : driver.places) {
      const Way& way = corridors_.way(place.way);
      if (way.zone == zone && way.kind == Way::Kind::exit) return false;
      if (way.kind != Way::Kind::lane || place.s < way.length - corridors_.body().front) continue;
      for (const std::uint32_t out : way.out)
        if (corridors_.way(out).zone == zone && corridors_.way(out).leave >= place.s) return false;
    }
  }
  return true;
}

}  // namespace sf::control
