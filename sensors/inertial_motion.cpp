#include "sensors/inertial_motion.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "base/displacement.h"
#include "robots/kinematics.h"

namespace sf::sensors {

namespace {

double seconds(std::int64_t time) { return 1e-9 * static_cast<double>(time); }

/// A fixed direction, `up` at first, in a frame that turns by `w` [rad/s]: exp(-[w] t) up.
class TurningUp {
 public:
  TurningUp(const glm::dvec3& up, const glm::dvec3& w)
      : rate_(base::hypot(w.x, w.y, w.z)), axis_(rate_ > 0.0 ? w / rate_ : w), along_(glm::dot(axis_, up) * axis_) {
    across_ = up - along_;
    sideways_ = glm::cross(axis_, up);
  }
  glm::dvec3 at(double time) const {
    const auto [s, c] = base::sin_cos(rate_ * time);
    return along_ + c * across_ - s * sideways_;
  }
  /// Returns the integral over `time` [s].
  glm::dvec3 integral(double time) const {
    const double angle = rate_ * time, half = 0.5 * angle;
    return time * (along_ + base::sinc(angle) * across_ - base::sin(half) * base::sinc(half) * sideways_);
  }

 private:
  double rate_;
  glm::dvec3 axis_, along_, across_, sideways_;
};

}  // namespace

glm::dvec3 InertialMotion::up(const base::Report& state) const {
  const glm::dmat3 R_WM = base::rotation_of(state.tilt.roll, state.tilt.pitch, state.X_WM.yaw);
  return glm::transpose(X_MS_.R) * glm::dvec3{R_WM[0].z, R_WM[1].z, R_WM[2].z};
}

InertialMotion::Segment InertialMotion::segment(const base::Report& from, const base::Report& to) const {
  Segment s{from.time, to.time, {}, {}, up(from)};
  if (!base::is_drivable(from.X_WM, to.X_WM, max_speed_, seconds(to.time - from.time))) {
    s.up = up(to);
    return s;
  }
  const base::BodyVelocity V = robots::velocity_between(from, to);
  const glm::dmat3 R_SM = glm::transpose(X_MS_.R);
  s.v = R_SM * (V.linear + glm::cross(V.angular, X_MS_.p));
  s.w = R_SM * V.angular;
  return s;
}

void InertialMotion::clear() {
  segments_.clear();
  first_ = 0;
  known_ = false;
}

void InertialMotion::add(const base::Report& state) {
  if (base::is_absent(state.X_WM)) return clear();
  if (known_ && state.time <= last_.time) return;
  if (known_) segments_.push_back(segment(last_, state));
  last_ = state;
  known_ = true;
  // The velocity of a segment that ends at the start of a mean is needed for the change there.
  while (first_ < segments_.size() && segments_[first_].to < state.time - duration_) ++first_;
  if (2 * first_ < segments_.size()) return;
  segments_.erase(segments_.begin(), segments_.begin() + static_cast<std::ptrdiff_t>(first_));
  first_ = 0;
}

InertialMeans InertialMotion::mean(const base::Report& now) const {
  if (!known_) return at_rest(now);
  const std::int64_t begin = now.time - duration_;
  const Segment* before = nullptr;
  glm::dvec3 turned{}, gained{};
  const auto take = [&](const Segment& s) {
    const std::int64_t from = std::max(s.from, begin), to = std::min(s.to, now.time);
    if (from < to) {
      const double since = seconds(from - s.from), time = seconds(to - from);
      if (s.from >= begin) gained += before == nullptr ? s.v : s.v - before->v;
      turned += time * s.w;
      gained += time * glm::cross(s.w, s.v);
      gained += gravity_ * TurningUp(TurningUp(s.up, s.w).at(since), s.w).integral(time);
    }
    before = &s;
  };
  const std::int64_t started = first_ < segments_.size() ? segments_[first_].from : last_.time;
  const glm::dvec3 first_up = first_ < segments_.size() ? segments_[first_].up : up(last_);
  const Segment rest{std::min(begin, started), started, {}, {}, first_up};
  take(rest);
  for (std::size_t i = first_; i < segments_.size(); ++i) take(segments_[i]);
  const Segment ahead = now.time > last_.time ? segment(last_, now) : Segment{};
  take(ahead);
  return {turned / seconds(duration_), gained / seconds(duration_)};
}

void InertialMotion::write(base::ByteWriter& out) const {
  out.put(static_cast<std::uint8_t>(known_ ? 1 : 0));
  const base::Report& s = last_;
  out.put(s.time);
  for (const double value : {s.X_WM.x, s.X_WM.y, s.X_WM.z, s.X_WM.yaw, s.tilt.roll, s.tilt.pitch}) out.put(value);
  out.put(static_cast<std::uint32_t>(segments_.size() - first_));
  for (std::size_t i = first_; i < segments_.size(); ++i) out.put_bytes(&segments_[i], sizeof segments_[i]);
}

void InertialMotion::read(base::ByteReader& in) {
  clear();
  known_ = in.get<std::uint8_t>() != 0;
  last_ = {};
  last_.time = in.get<std::int64_t>();
  for (double* value :
       {&last_.X_WM.x, &last_.X_WM.y, &last_.X_WM.z, &last_.X_WM.yaw, &last_.tilt.roll, &last_.tilt.pitch})
    *value = in.get<double>();
  for (auto count = in.get<std::uint32_t>(); count > 0 && in.good(); --count)
    in.get_into(&segments_.emplace_back(), sizeof(Segment));
}

}  // namespace sf::sensors
