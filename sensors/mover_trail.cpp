#include "sensors/mover_trail.h"

#include <algorithm>

#include "base/displacement.h"
#include "base/elementary.h"
#include "robots/kinematics.h"

namespace sf::sensors {

void MoverTrail::add(const base::Report& state) {
  if (base::is_absent(state.X_WM)) return clear();
  if (!states_.empty() && state.time <= states_.back().time) return;
  states_.push_back(state);
  const auto covers = [&](const base::Report& each) { return each.time > state.time - duration_; };
  const auto first = std::ranges::find_if(states_, covers);
  if (first - states_.begin() > 1) states_.erase(states_.begin(), first - 1);
}

base::Report MoverTrail::between(const base::Report& from, const base::Report& to, std::int64_t time) const {
  const double seconds = 1e-9 * static_cast<double>(to.time - from.time);
  if (time >= to.time || base::is_absent(to.X_WM) || !base::is_drivable(from.X_WM, to.X_WM, max_speed_, seconds))
    return to;
  return robots::interpolate(from, to, time);
}

base::Report MoverTrail::at(std::int64_t time, const base::Report& now) const {
  const base::Report* later = &now;
  for (auto state = states_.rbegin(); state != states_.rend(); ++state) {
    if (state->time >= later->time) continue;  // `now` is that tick
    if (state->time <= time) return between(*state, *later, time);
    // A relocation on the way ends the motion.
    const double seconds = 1e-9 * static_cast<double>(later->time - state->time);
    if (!base::is_drivable(state->X_WM, later->X_WM, max_speed_, seconds)) return *later;
    later = &*state;
  }
  return *later;
}

double MoverTrail::reach(const base::Report& now) const {
  double most = 0.0;
  for (const base::Report& state : states_)
    most = std::max(most, base::hypot(state.X_WM.x - now.X_WM.x, state.X_WM.y - now.X_WM.y, state.X_WM.z - now.X_WM.z));
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
