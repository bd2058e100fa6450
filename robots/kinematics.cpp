#include "robots/kinematics.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "base/rigid_transform.h"
#include "base/tilted_pose.h"

namespace sf::robots {

namespace {

constexpr double kSame = 1e-7;  // [m], [rad] poses within this distance are equal except for rounding

bool near(const base::Pose& p, const base::Pose& q) {
  return std::abs(p.x - q.x) <= kSame && std::abs(p.y - q.y) <= kSame &&
         std::abs(base::wrap_angle(p.yaw - q.yaw)) <= kSame;
}

}  // namespace

base::Twist twist_between(const base::Pose& from, const base::Pose& to, double seconds) {
  const double turn = base::wrap_angle(to.yaw - from.yaw);
  const glm::dvec2 chord = base::rotate(-(from.yaw + 0.5 * turn), {to.x - from.x, to.y - from.y});
  const double per = 1.0 / (base::sinc(0.5 * turn) * seconds);
  return {per * chord.x, per * chord.y, turn / seconds};
}

namespace {

bool is_level(const base::Report& before, const base::Report& after) {
  return base::is_level(before.tilt) && base::is_level(after.tilt);
}

/// True for bitwise equal poses.
bool is_at_rest(const base::Report& before, const base::Report& after) {
  const base::Pose &from = before.X_WM, &to = after.X_WM;
  return from.x == to.x && from.y == to.y && from.z == to.z && from.yaw == to.yaw &&
         before.tilt.roll == after.tilt.roll && before.tilt.pitch == after.tilt.pitch;
}

double seconds_between(const base::Report& before, const base::Report& after) {
  return 1e-9 * static_cast<double>(after.time - before.time);
}

/// Returns the planar velocity between two states, disregarding tilt.
base::Twist planar_velocity(const base::Report& before, const base::Report& after) {
  const double seconds = seconds_between(before, after);
  const bool led = near(advance(before.X_WM, after.velocity, seconds), after.X_WM);
  return led ? after.velocity : twist_between(before.X_WM, after.X_WM, seconds);
}

}  // namespace

base::Twist finite(const base::Twist& twist) {
  const auto or_0 = [](double v) { return std::isfinite(v) ? v : 0.0; };
  return {or_0(twist.forward), or_0(twist.left), or_0(twist.turn)};
}

base::Pose advance(const base::Pose& X_WM, const base::Twist& velocity, double dt) {
  // The integral of R(yaw + w t) v over dt is R(yaw + w dt/2) v sinc(w dt/2) dt: the chord of the arc.
  const double half = 0.5 * velocity.turn * dt;
  const double chord = base::sinc(half) * dt;
  const glm::dvec2 d = base::rotate(X_WM.yaw + half, {chord * velocity.forward, chord * velocity.left});
  return {X_WM.x + d.x, X_WM.y + d.y, X_WM.z, base::wrap_angle(X_WM.yaw + velocity.turn * dt)};
}

base::Report extrapolate(const base::Report& known, std::int64_t time) {
  const std::int64_t ahead = std::clamp<std::int64_t>(time - known.time, 0, kMaxExtrapolation);
  base::Report report = known;
  if (ahead == 0) return report;  // bitwise equal, for any yaw
  report.time += ahead;
  report.X_WM = advance(known.X_WM, known.velocity, 1e-9 * static_cast<double>(ahead));
  return report;
}

base::Report interpolate(const base::Report& before, const base::Report& after, std::int64_t time) {
  base::Report report = before;
  report.time = time, report.wheels = after.wheels;
  // Bitwise equal poses allow readings of a mover at rest to be reused.
  if (is_at_rest(before, after)) {
    report.velocity = after.velocity;
    return report;
  }
  report.velocity = planar_velocity(before, after);
  const double since = 1e-9 * static_cast<double>(time - before.time);
  if (is_level(before, after)) {
    report.X_WM = advance(before.X_WM, report.velocity, since);
    if (after.X_WM.z != before.X_WM.z)
      report.X_WM.z += since / seconds_between(before, after) * (after.X_WM.z - before.X_WM.z);
  } else if (since > 0.0) {
    const auto between = base::screw_between({before.X_WM, before.tilt}, {after.X_WM, after.tilt},
                                             since / seconds_between(before, after));
    report.X_WM = between.X, report.tilt = between.tilt;
  }
  return report;
}

base::BodyVelocity velocity_between(const base::Report& before, const base::Report& after) {
  if (is_at_rest(before, after)) return {};
  if (!is_level(before, after))
    return base::screw_velocity({before.X_WM, before.tilt}, {after.X_WM, after.tilt}, seconds_between(before, after));
  const base::Twist v = planar_velocity(before, after);
  const double rise = (after.X_WM.z - before.X_WM.z) / seconds_between(before, after);
  return {{v.forward, v.left, rise}, {0.0, 0.0, v.turn}};
}

WorldVelocity velocity_on_slope(const base::Report& state) {
  constexpr double kLeastUpright = 0.3;  // cosine of the tilt
  const glm::dvec3 up = base::rotation_of(state.tilt.roll, state.tilt.pitch, state.X_WM.yaw)[2];
  const glm::dvec2 flat = base::rotate(state.X_WM.yaw, {state.velocity.forward, state.velocity.left});
  const double rise = up.z > kLeastUpright ? -(flat.x * up.x + flat.y * up.y) / up.z : 0.0;
  return {{flat.x, flat.y, rise}, state.velocity.turn * up};
}

}  // namespace sf::robots
