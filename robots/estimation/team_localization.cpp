#include "robots/estimation/team_localization.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sf::estimation {

namespace {

constexpr std::int64_t kLatestTime = std::int64_t{1} << 61;  // [ns]
// Robots without sightings advance by steps at whole seconds, which bounds the speeds to keep. After a longer gap in
// the odometry they are skipped.
constexpr std::int64_t kTeamStep = 1'000'000'000;
constexpr std::int64_t kMostSteps = 60;
constexpr std::size_t kEventsPerRobot = 64;

bool is_time(std::int64_t time) { return time >= 0 && time <= kLatestTime; }
bool is_magnitude(double v) { return std::abs(v) <= 1e9; }

}  // namespace

TeamLocalization::TeamLocalization(Team team)
    : team_(std::move(team)),
      speeds_(team_.robots),
      most_speeds_(team_.robots, 256),
      next_step_(team_.robots, -1),
      window_(kWindow, kEventsPerRobot * team_.robots, first_state(team_)),
      ahead_(team_.robots) {}

auto TeamLocalization::apply_to_state() {
  return [this](const TeamEvent& event, TeamState& state) {
    const TeamResult result = estimation::apply(team_, event, speeds_, state);
    last_squared_ = result.squared;
    if (result.use == TeamUse::outlier) return Verdict::outlier;
    if (result.use == TeamUse::unknown) return Verdict::no_track;
    return event.kind == TeamEvent::Kind::pose ? Verdict::started : Verdict::used;
  };
}

Verdict TeamLocalization::take(const TeamEvent& event) {
  const Verdict verdict = window_.take(event, apply_to_state());
  for (Ahead& each : ahead_) each.from = -1;
  return verdict;
}

Verdict TeamLocalization::add_pose(std::uint32_t robot, std::int64_t time, const base::Pose& X_WM,
                                   const PoseCovariance& covariance) {
  Verdict verdict = Verdict::invalid;
  if (robot < team_.robots && is_time(time) &&
      is_valid(Measurement{.time = time, .components = kPoseBits, .X_WM = X_WM, .pose_covariance = covariance})) {
    verdict = take(start_event(robot, time, X_WM, covariance));
    if (next_step_[robot] < 0) next_step_[robot] = (time / kTeamStep + 1) * kTeamStep;
  }
  ++counts_[static_cast<std::size_t>(verdict)];
  return verdict;
}

Verdict TeamLocalization::add_odometry(std::uint32_t robot, std::int64_t time, double forward, double turn) {
  if (robot >= team_.robots || !is_time(time) || !is_magnitude(forward) || !is_magnitude(turn)) return Verdict::invalid;
  const Speeds speeds = effective_speeds(team_.model, time, forward, turn);
  const TeamState& before = window_.before();
  if (before.known() && speeds.time < before.event) return Verdict::too_late;
  std::vector<Speeds>& all = speeds_[robot];
  const auto place = std::lower_bound(all.begin(), all.end(), speeds);
  if (place != all.end() && *place == speeds) return Verdict::replayed;
  all.insert(place, speeds);
  if (speeds.time < ahead_[robot].time) ahead_[robot].from = -1;
  window_.apply_after(speeds.time, apply_to_state());
  step_to(robot, speeds.time);
  if (all.size() >= most_speeds_[robot]) forget(robot, all.back().time);
  return Verdict::used;
}

void TeamLocalization::step_to(std::uint32_t robot, std::int64_t time) {
  std::int64_t& next = next_step_[robot];
  if (next < 0) return;
  if (time - next > kMostSteps * kTeamStep) next = time / kTeamStep * kTeamStep;
  for (; next <= time; next += kTeamStep) take({.time = next, .robot = robot});
}

/// Drops the speeds before the states in the window.
void TeamLocalization::forget(std::uint32_t robot, std::int64_t newest) {
  const TeamState& before = window_.before();
  std::int64_t needed = newest - kWindow - 2 * kTeamStep;
  if (before.known() && before.robots[robot].time >= 0) needed = before.robots[robot].time;
  std::vector<Speeds>& all = speeds_[robot];
  const auto later = [](std::int64_t t, const Speeds& each) { return t < each.time; };
  const auto first = std::upper_bound(all.begin(), all.end(), needed, later);
  if (first - all.begin() > 1) all.erase(all.begin(), first - 1);
  most_speeds_[robot] = 2 * all.size() + 256;
}

Verdict TeamLocalization::add_sighting(std::uint32_t robot, std::int64_t time, std::uint32_t target, double range,
                                       double bearing) {
  Verdict verdict = Verdict::invalid;
  if (robot < team_.robots && target < team_.robots + team_.landmarks.size() && is_time(time) && range > 0.0 &&
      is_magnitude(range) && is_magnitude(bearing)) {
    verdict = take(sighting_event(team_.model, robot, time, target, range, bearing));
    if (verdict == Verdict::used) squared_ += last_squared_;
  }
  ++counts_[static_cast<std::size_t>(verdict)];
  return verdict;
}

Prediction TeamLocalization::predict(std::uint32_t robot, std::int64_t time) const {
  const TeamState* state = window_.state_at(time);
  if (robot >= team_.robots || state == nullptr) return {};
  const std::int64_t own = state->robots[robot].time;
  if (own < 0) return {};
  const std::vector<Speeds>& speeds = speeds_[robot];
  Ahead& ahead = ahead_[robot];
  if (ahead.from != own || ahead.time > time) ahead = {own, own, TeamMotion::from(*state, robot)};
  // Stop at the newest speeds: from there the next prediction continues with the same bits.
  const auto after = std::upper_bound(speeds.begin(), speeds.end(), time,
                                      [](std::int64_t t, const Speeds& each) { return t < each.time; });
  if (after != speeds.begin() && (after - 1)->time > ahead.time) {
    drive(team_.model, ahead.time, (after - 1)->time, speeds, ahead.motion);
    ahead.time = (after - 1)->time;
  }
  TeamMotion moved = ahead.motion;
  drive(team_.model, ahead.time, time, speeds, moved);
  return {Prediction::Status::fresh, time - state->event, estimate_after(team_, *state, robot, moved, time)};
}

}  // namespace sf::estimation
