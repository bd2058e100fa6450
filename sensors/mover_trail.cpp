#include "sensors/mover_trail.h"

#include <algorithm>

#include "base/displacement.h"
#include "base/elementary.h"
#include "robots/kinematics.h"

namespace sf::sensors {

namespace {

/// Returns the state at `time`, between two ticks with a relocation. It took place at the first of them, and the mover
/// has driven with the velocity of the second since; before, it stood still.
base::Report relocated(const base::Report& from, const base::Report& to, std::int64_t time) {
  base::Report state = to;
  state.time = time;
  const double before = 1e-9 * static_cast<double>(to.time - std::max(time, from.time));
  state.X_WM = robots::advance(to.X_WM, to.velocity, -before);
  return state;
}

}  // namespace

void MoverTrail::add(const base::Report& state) {
  if (base::is_absent(state.X_WM)) return clear();
  if (!states_.empty() && state.time <= states_.back().time) return;
  states_.push_back(state);
  const auto covers = [&](const base::Report& each) { return each.time > state.time - duration_; };
  const auto first = std::ranges::find_if(states_, covers);
  if (first - states_.begin() > 1) states_.erase(states_.begin(), first - 1);
}

bool MoverTrail::drove(const base::Report& from, const base::Report& to) const {
  return base::is_drivable(from.X_WM, to.X_WM, max_speed_, 1e-9 * static_cast<double>(to.time - from.time));
}

base::Report MoverTrail::between(const base::Report& from, const base::Report& to, std::int64_t time) const {
  if (time >= to.time || base::is_absent(to.X_WM)) return to;
  return drove(from, to) ? robots::interpolate(from, to, time) : relocated(from, to, time);
}

base::Report MoverTrail::at(std::int64_t time, const base::Report& now) const {
  const base::Report* later = &now;
  for (auto state = states_.rbegin(); state != states_.rend(); ++state) {
    if (state->time >= later->time) continue;  // `now` is that tick
    if (state->time <= time || !drove(*state, *later)) return between(*state, *later, time);
    later = &*state;
  }
  return *later;
}

double MoverTrail::reach(const base::Report& now) const {
  double most = 0.0;
  const auto include = [&](const base::Report& state) {
    const base::Pose &X = state.X_WM, &Y = now.X_WM;
    most = std::max(most, base::hypot(X.x - Y.x, X.y - Y.y, X.z - Y.z));
  };
  const base::Report* earlier = nullptr;
  const auto add = [&](const base::Report& state) {
    include(state);
    if (earlier != nullptr && earlier->time < state.time && !drove(*earlier, state))
      include(relocated(*earlier, state, earlier->time));
    earlier = &state;
  };
  for (const base::Report& state : states_) add(state);
  add(now);
  return most;
}

bool MoverTrail::at_rest(std::int64_t time, const base::Report& now) const {
  for (auto state = states_.rbegin(); state != states_.rend(); ++state) {
    if (!is_same_place(*state, now)) return false;
    if (state->time <= time) break;
  }
  return true;
}

bool MoverTrail::is_longer(const MoverTrail& other) const {
  return !states_.empty() && (other.states_.empty() || states_.front().time < other.states_.front().time);
}

void MoverTrail::write(base::ByteWriter& out) const {
  out.put(static_cast<std::uint32_t>(states_.size()));
  for (const base::Report& s : states_) {
    out.put(s.time);
    for (const double value : {s.X_WM.x, s.X_WM.y, s.X_WM.z, s.X_WM.yaw, s.velocity.forward, s.velocity.left,
                               s.velocity.turn, s.tilt.roll, s.tilt.pitch})
      out.put(value);
  }
}

void MoverTrail::read(base::ByteReader& in) {
  states_.clear();
  for (auto count = in.get<std::uint32_t>(); count > 0 && in.good(); --count) {
    base::Report s;
    s.time = in.get<std::int64_t>();
    for (double* value : {&s.X_WM.x, &s.X_WM.y, &s.X_WM.z, &s.X_WM.yaw, &s.velocity.forward, &s.velocity.left,
                          &s.velocity.turn, &s.tilt.roll, &s.tilt.pitch})
      *value = in.get<double>();
    states_.push_back(s);
  }
}

}  // namespace sf::sensors
