#include "control/explore.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "base/marked_values.h"
#include "control/drive_to_point.h"
#include "sensors/laser.h"

namespace sf::control {

namespace {

using base::Pose;
using base::Twist;

constexpr double kFreeAtStart = 0.02;    // [m] initially free ground beyond the body and the parts on it
constexpr double kAligned = 0.01;        // [rad] tolerance at which a heading is reached
constexpr double kMovingAligned = 0.05;  // [rad] the same in a moving world, where poses are less precise
constexpr double kTouch = 5e-4;          // [m] minimum distance to a surface
constexpr double kNearRange = 0.85;      // part of the laser's range used in the first stage
constexpr double kFarRange = 1.0;
constexpr int kGraze = 2;  // nodes

constexpr int kMostBlocked = 10;                    // plans
constexpr std::int64_t kPause = 1'000'000'000;      // [ns] until the next plan while teammates explore the rest
constexpr std::int64_t kMostPause = 8'000'000'000;  // [ns] the same in a moving world, where planning costs more
constexpr double kMoreClearance = 0.05;             // [m] beyond the margin

constexpr std::int64_t kStuck = 15'000'000'000;  // [ns] at one place while commands are executed: two full turns
constexpr double kOnePlace = 0.15;               // [m]

glm::dvec2 origin(const Pose& X) { return {X.x, X.y}; }

double reach_of(const ExploreSettings& settings) {
  return std::max(settings.body.radius, glm::length(settings.body.p_MS));
}

}  // namespace

/// Targets, margin and range of one stage of the exploration.
struct Explore::Stage {
  bool roomy;
  bool all;
  double range;
  int graze;
};
constexpr Explore::Stage Explore::kStage[kStages] = {{true, false, kNearRange, 0},
                                                     {true, false, kFarRange, 0},
                                                     {false, false, kFarRange, 0},
                                                     {false, true, kFarRange, 0},
                                                     {false, false, kFarRange, kGraze}};

Explore::Explore(const ExploreSettings& settings)
    : settings_(settings),
      map_(settings.geometry, settings.body.radius, reach_of(settings),
           {std::max(ExplorationMapSettings{}.most_clearance, settings.margin + kMoreClearance), settings.moving}),
      search_(map_, settings.body),
      viewpoint_planner_(map_, settings.eye),
      pause_(kPause) {
  settings_.eye.range = std::min(settings_.eye.range, settings_.view);
  if (!settings.team) return;
  team_.emplace(*settings.team);
  map_.record_changes();
}

double Explore::v2v_range() const {
  const double swept = settings_.swept_area ? settings_.swept_area->v2v_range() : 0.0;
  return std::max(team_ ? team_->radio() : 0.0, swept);
}

double Explore::aligned() const { return settings_.moving ? kMovingAligned : kAligned; }

Twist Explore::step(const ControllerInput& input) {
  const Twist twist = checked(input, decide(input));
  if (!team_) return twist;
  std::vector<std::int64_t> claim;
  for (const maps::CellAt cell : targets_) claim.push_back(map_.key(cell));
  team_->publish(input.time, std::move(claim), map_);
  return twist;
}

Twist Explore::decide(const ControllerInput& input) {
  const Pose& X_WM = input.state.X_WM;
  const bool merged = team_ && team_->update(input, map_);
  const bool news = update_map(input) || merged;
  if (!started_) {
    map_.mark_free(origin(X_WM), reach_of(settings_) + kFreeAtStart);
    last_yaw_ = X_WM.yaw;
    last_time_ = input.time;
    started_ = true;
  }
  if (done()) return {};
  if (!turned_once_) return turn_once(X_WM);
  if (input.contact) {
    // A contact with an obstacle that no beam hit.
    const double ahead = legs_.empty() || !legs_.back().backwards ? 1.0 : -1.0;
    const glm::dvec2 p = base::transform(X_WM, {ahead * settings_.body.radius, 0.0});
    if (!team_ || !team_->is_body(p)) map_.add_point(p);
    path_.clear();
  }
  if (team_) drop_claimed_targets();
  if (input.time < paused_until_) return {};
  if (path_.empty() || targets_seen() || (news && blocked())) plan(input);
  const Twist twist = done() || path_.empty() ? Twist{} : legs_.empty() ? wait(input) : drive(input);
  last_time_ = input.time;
  return twist;
}

bool Explore::update_map(const ControllerInput& input) {
  const base::ReadingBlock* reading = newest(input, sensors::kLaser);
  if (reading == nullptr || reading->values.size() != settings_.beams.size() || sequence_ == reading->sequence)
    return false;
  sequence_ = reading->sequence;
  X_WS_ = reading->X_WS;
  auto ranges = base::marked_values(*reading, ranges_);  // ranges from `eye.range` on free the cells up to there
  if (team_) ranges = without_bodies(*reading, ranges);
  return map_.add({reading->X_WS, ranges, settings_.beams, settings_.range_min, settings_.eye.range});
}

// Removes the ranges that end on other robots, which will not stay there.
std::span<const double> Explore::without_bodies(const base::ReadingBlock& reading, std::span<const double> ranges) {
  seen_ranges_.assign(ranges.begin(), ranges.end());
  for (std::size_t i = 0; i < ranges.size(); ++i)
    if (ranges[i] < settings_.eye.range &&
        team_->is_body(base::transform(reading.X_WS, ranges[i] * settings_.beams[i])))
      seen_ranges_[i] = std::nan("");
  return seen_ranges_;
}

// Gives up the cells that a teammate with priority has claimed.
void Explore::drop_claimed_targets() {
  std::erase_if(targets_, [&](maps::CellAt cell) {
    return grid().at(cell) == maps::Cell::unexplored && team_->claimed(cell, map_);
  });
}

// Makes one full turn in place at the start.
Twist Explore::turn_once(const Pose& X_WM) {
  turned_ += base::wrap_angle(X_WM.yaw - last_yaw_);
  last_yaw_ = X_WM.yaw;
  turned_once_ = turned_ >= 2.0 * M_PI;
  return {0.0, 0.0, turned_once_ ? 0.0 : settings_.turn};
}

bool Explore::targets_seen() const {
  return std::none_of(targets_.begin(), targets_.end(),
                      [&](maps::CellAt cell) { return grid().at(cell) == maps::Cell::unexplored; });
}

bool Explore::blocked() const {
  const double margin = kStage[stage_].roomy ? settings_.margin : settings_.least_margin;
  return std::any_of(path_.begin() + 1, path_.end(), [&](const LatticeState& state) {
    return !search_.allowed(state, margin) && !search_.allowed(state, 0.0);
  });
}

void Explore::plan(const ControllerInput& input) {
  const Pose& X_WM = input.state.X_WM;
  arrived_.reset();
  legs_.clear();
  int heading = 0;
  for (int k = 1; k < kHeadings; ++k)
    if (std::abs(base::wrap_angle(heading_angle(k) - X_WM.yaw)) <
        std::abs(base::wrap_angle(heading_angle(heading) - X_WM.yaw)))
      heading = k;
  const LatticeState from{map_.node_at(origin(X_WM)), heading};
  std::function<bool(maps::CellAt)> claimed;
  if (team_) claimed = [&](maps::CellAt cell) { return team_->claimed(cell, map_); };
  targets_.clear();
  in_way_since_.reset();
  map_.refresh();
  // Nothing is reachable from outside; estimates of poses may leave the map for a moment.
  const bool outside = !map_.surrounds(origin(X_WM));
  if (outside && settings_.moving) return pause(input.time);
  if (outside) stage_ = kStages;
  for (; stage_ < kStages; ++stage_) {
    const Stage& stage = kStage[stage_];
    if (stage.graze > 0 && !settings_.thorough) continue;
    const double range = stage.range * settings_.eye.range;
    const bool any = viewpoint_planner_.update(stage.all, range, stage.graze, claimed) > 0;
    if (any && find_goal(from, stage)) return path_.empty() ? pause(input.time) : set_path(path_);
    if (viewpoint_planner_.claimed() > 0) return pause(input.time);
  }
  path_.clear();
}

// Returns whether a goal is reachable. Its path remains empty while the bodies of others block it. Blocked goals count
// as unreachable after several plans, because robots that are done stay where they are.
bool Explore::find_goal(const LatticeState& from, const Stage& stage) {
  const auto find = [&] {
    return search_.find(from, stage.roomy ? settings_.margin : settings_.least_margin, [&](const LatticeState& state) {
      return viewpoint_planner_.sees_target(search_.sensor_at(state), state.heading);
    });
  };
  if (team_) team_->add_bodies(map_);
  path_ = find();
  if (!path_.empty()) blocked_plans_ = 0;
  if (!path_.empty() || !team_) return !path_.empty();
  map_.set_bodies({}, {});
  return blocked_plans_ < kMostBlocked && !find().empty() && ++blocked_plans_ < kMostBlocked;
}

// Waits at rest while teammates explore the remaining cells or block the path.
void Explore::pause(std::int64_t time) {
  paused_until_ = time + pause_;
  if (settings_.moving) pause_ = std::min(2 * pause_, kMostPause);
  path_.clear();
}

// Splits a path into turns and straight lines.
void Explore::set_path(const std::vector<LatticeState>& way) {
  pause_ = kPause;
  targets_ = viewpoint_planner_.targets(search_.sensor_at(way.back()), way.back().heading);
  const auto is_turn = [&](std::size_t i) { return way[i].heading != way[i - 1].heading; };
  const auto step = [&](std::size_t i) {
    return is_turn(i) ? (way[i].heading - way[i - 1].heading + kHeadings) % kHeadings : way[i].node - way[i - 1].node;
  };
  std::vector<Leg> legs;
  for (std::size_t i = 1; i < way.size();) {
    std::size_t last = i;
    while (last + 1 < way.size() && is_turn(last + 1) == is_turn(i) && step(last + 1) == step(i)) ++last;
    Leg leg{!is_turn(i), map_.place(way[last].node), false, heading_angle(way[last].heading), 1.0};
    const glm::dvec2 along = map_.place(way[last].node) - map_.place(way[i - 1].node);
    leg.backwards = leg.straight && glm::dot(along, base::rotate(leg.heading, {1.0, 0.0})) < 0.0;
    leg.side = step(i) == 1 ? 1.0 : -1.0;
    legs.push_back(leg);
    i = last + 1;
  }
  // The last leg ends at the goal's place and heading.
  legs.push_back({true, map_.place(way.back().node), !legs.empty() && legs.back().backwards,
                  heading_angle(way.back().heading), 1.0});
  legs.push_back({false, {}, false, heading_angle(way.back().heading), 0.0});
  legs_.assign(legs.rbegin(), legs.rend());
}

bool Explore::finished(const Leg& leg, const Pose& X_WM) const {
  if (!leg.straight) return std::abs(base::wrap_angle(leg.heading - X_WM.yaw)) < aligned();
  const glm::dvec2 rest = leg.end - origin(X_WM);
  const double ahead = glm::dot(rest, base::rotate(leg.heading, {leg.backwards ? -1.0 : 1.0, 0.0}));
  return glm::length(rest) < here() || ahead < 0.5 * here();
}

Twist Explore::drive(const ControllerInput& input) {
  const Pose& X_WM = input.state.X_WM;
  while (!legs_.empty() && finished(legs_.back(), X_WM)) legs_.pop_back();
  if (legs_.empty()) return wait(input);
  const double dt = std::clamp(1e-9 * static_cast<double>(input.time - last_time_), 0.02, 0.5);
  const Twist twist = follow(legs_.back(), X_WM, dt);
  if (team_ && twist.forward != 0.0 && team_->blocks(base::transform(X_WM, {0.2 * twist.forward, 0.0}))) {
    if (!in_way_since_) in_way_since_ = input.time;
    if (input.time - *in_way_since_ >= kPause) give_up();
    return {};
  }
  in_way_since_.reset();
  if (safe(X_WM, twist, dt)) return twist;
  give_up();
  return {};
}

Twist Explore::follow(const Leg& leg, const Pose& X_WM, double dt) const {
  const DriveLimits pace{settings_.speed, settings_.turn, 0.03, std::min(0.7 / dt, 5.0)};
  if (!leg.straight) {
    // Keeps the direction of the turn only for large heading errors.
    double off = base::wrap_angle(leg.heading - X_WM.yaw);
    if (leg.side * off < 0.0 && std::abs(off) > 0.3) off += leg.side * 2.0 * M_PI;
    return {0.0, 0.0, turn_to(off, pace)};
  }
  const glm::dvec2 rest = leg.end - origin(X_WM);
  const double far = glm::length(rest), sign = leg.backwards ? -1.0 : 1.0;
  const double bearing = far < 0.02 ? leg.heading : base::atan2(sign * rest.y, sign * rest.x);
  const double off = base::wrap_angle(bearing - X_WM.yaw);
  if (std::abs(off) > pace.aim) return {0.0, 0.0, turn_to(off, pace)};
  const glm::dvec2 front = base::transform(X_WM, {sign * settings_.slow, 0.0});
  const bool near = map_.nearest(front, 1.0) < settings_.body.radius + settings_.slow;
  const double speed = std::min(near ? settings_.slow_speed : settings_.speed, far / dt);
  return {sign * speed, 0.0, turn_to(off, pace)};
}

// Rejects a twist with which the body would touch a surface within two steps, unless the distance grows.
bool Explore::safe(const Pose& X_WM, const Twist& twist, double dt) const {
  if (twist.forward == 0.0 || settings_.swept_area) return true;
  const double now = map_.nearest(origin(X_WM), 1.0);
  const double rest = glm::length(legs_.back().end - origin(X_WM));
  const double ahead = std::copysign(std::min(2.0 * dt * std::abs(twist.forward), rest + here()), twist.forward);
  const double then = map_.nearest(base::transform(X_WM, {ahead, 0.0}), 1.0);
  return then >= settings_.body.radius + kTouch || then > now;
}

// Replaces a command whose swept area is not free, and gives up the path if that lasts. Next to an obstacle, a turn and
// its evasion may alternate for ever: a robot that does not leave its place drives away from it, and plans again.
Twist Explore::checked(const ControllerInput& input, const Twist& wanted) {
  if (!settings_.swept_area) return wanted;
  SweptArea& area = *settings_.swept_area;
  area.update(input);
  const bool rests = wanted.forward == 0.0 && wanted.turn == 0.0;
  if (!stands_ || rests || glm::length(origin(input.state.X_WM) - stands_->p) > kOnePlace) {
    if (stands_ && stands_->leaves) path_.clear();
    stands_ = {origin(input.state.X_WM), input.time};
  }
  if (rests) return wanted;
  if (input.time - stands_->since > kStuck) {
    stands_->leaves = true;
    for (const double ahead : {0.5 * settings_.slow_speed, -0.5 * settings_.slow_speed})
      if (area.free(input.state, {ahead, 0.0, 0.0})) return {ahead, 0.0, 0.0};
  }
  const Twist twist = area.limit(input.state, wanted, 0.5 * settings_.turn, 0.5 * settings_.slow_speed);
  if (twist.forward * wanted.forward > 0.0 || (wanted.forward == 0.0 && twist.turn * wanted.turn > 0.0)) {
    evades_since_.reset();
    return twist;
  }
  if (!evades_since_) evades_since_ = input.time;
  if (input.time - *evades_since_ < kPause) return twist;
  evades_since_.reset();
  if (!path_.empty()) give_up();
  return twist;
}

// Waits at the goal for a scan.
Twist Explore::wait(const ControllerInput& input) {
  if (!arrived_) arrived_ = input.time;
  const Pose X_WS = base::compose(input.state.X_WM, settings_.eye.X_MS);
  const bool arrived = sequence_ && glm::length(origin(X_WS) - origin(X_WS_)) < here() &&
                       std::abs(base::wrap_angle(X_WS.yaw - X_WS_.yaw)) < aligned();
  const bool late = 1e-9 * static_cast<double>(input.time - *arrived_) > settings_.patience;
  if (!arrived && !late) return {};
  give_up();
  return {};
}

// Gives up the targets of this goal: they are not visible from there, or the goal is unreachable.
void Explore::give_up() {
  for (const maps::CellAt cell : targets_)
    if (grid().at(cell) == maps::Cell::unexplored)
      viewpoint_planner_.mark_unseen(cell, search_.sensor_at(path_.back()));
  path_.clear();
}

}  // namespace sf::control
