// How a mover of a fleet comes up to things, and what it then touches.

#include <algorithm>
#include <cmath>

#include "robots/fleet.h"
#include "robots/motion.h"

namespace sf::robots {

namespace {

using base::Pose;
using base::Twist;
using base::Vec2;
using world::Segment;

constexpr double kGap = 4e-4;  // [m] a refused mover stops no farther away than this
constexpr std::uint32_t kEverywhere = 0xFFFFFFFFu;
static_assert(base::kTouchSectors == 32);
constexpr double kYields[] = {1e-3, 2e-3, 4e-3};  // [m] that a turning body pushes itself off by

Vec2 origin(const Pose& X_WM) { return {X_WM.x, X_WM.y}; }

bool moves(const Twist& v) { return v.forward != 0.0 || v.left != 0.0 || v.turn != 0.0; }

// Not nearer to what was touched already; rounding at 100 km is 1.5e-11.
bool no_nearer(double after, double before) { return after >= before - 1e-10; }

Vec2 unit(Vec2 v) {
  const double size = length(v);
  return size > 0.0 ? 1.0 / size * v : Vec2{};
}

}  // namespace

void Fleet::move_one(std::uint32_t row, const Twist& velocity, double dt) {
  reports_[row].velocity = velocity;
  if (!moves(velocity)) return;
  const Outline& outline = outlines_[row];
  reach_.own = (std::hypot(velocity.forward, velocity.left) + std::abs(velocity.turn) * outline.radius) * dt;
  if (clear(row, reports_)) {
    reports_[row].X_WM = advance(reports_[row].X_WM, velocity, dt);
    return;
  }
  const auto steps = static_cast<std::int64_t>(std::ceil(reach_.own / outline.step));
  move_in_steps(row, velocity, dt / static_cast<double>(steps), steps);
}

void Fleet::move_in_steps(std::uint32_t row, Twist velocity, double dt, std::int64_t steps) {
  for (std::int64_t i = 0; i < steps; ++i) {
    if (step(row, velocity, dt)) continue;
    refused_[row] = 1;
    const bool in_place = velocity.forward == 0.0 && velocity.left == 0.0;
    if (!in_place) {
      press(row, velocity, dt);
      velocity = {0.0, 0.0, world_.movers[row].drive == world::Drive::car ? 0.0 : velocity.turn};
      if (velocity.turn != 0.0 && step(row, velocity, dt)) continue;
    }
    if (velocity.turn != 0.0 && turn_against(row, velocity, dt)) continue;
    velocity = {};
    break;
  }
  reports_[row].velocity = velocity;
}

bool Fleet::step(std::uint32_t row, const Twist& velocity, double dt) {
  const Pose X_WM = advance(reports_[row].X_WM, velocity, dt);
  if (refused(row, X_WM)) return false;
  reports_[row].X_WM = X_WM;
  return true;
}

// As far along a refused step as there is nothing in the way; how long that takes [s]. The least part is tried first:
// who presses already stays.
double Fleet::press(std::uint32_t row, const Twist& velocity, double dt) {
  const Pose X_start = reports_[row].X_WM;
  const int halvings = std::max(0, static_cast<int>(std::ceil(std::log2(outlines_[row].step / kGap))));
  double free = std::ldexp(1.0, -halvings), blocked = 1.0;
  if (refused(row, advance(X_start, velocity, free * dt))) return 0.0;
  for (int k = 0; k < halvings; ++k) {
    const double middle = 0.5 * (free + blocked);
    (refused(row, advance(X_start, velocity, middle * dt)) ? blocked : free) = middle;
  }
  reports_[row].X_WM = advance(X_start, velocity, free * dt);
  return free * dt;
}

// Who is not near enough yet to push itself off turns until it is.
bool Fleet::turn_against(std::uint32_t row, const Twist& velocity, double dt) {
  if (push_off(row, velocity, dt)) return true;
  const double done = press(row, velocity, dt);
  return done > 0.0 && push_off(row, velocity, dt - done);
}

// A body that is not quite round (a disc of sixteen sides) pushes itself off what it presses on when it turns.
bool Fleet::push_off(std::uint32_t row, const Twist& velocity, double dt) {
  const Vec2 away = unit(touch_of(row, reports_).away);
  if (away.x == 0.0 && away.y == 0.0) return false;
  const Pose X_turned = advance(reports_[row].X_WM, velocity, dt);
  for (const double yield : kYields) {
    Pose X_WM = X_turned;
    X_WM.x += yield * away.x;
    X_WM.y += yield * away.y;
    if (refused(row, X_WM)) continue;
    reports_[row].X_WM = X_WM;
    return true;
  }
  return false;
}

// Nothing within the circle that holds all the mover can sweep this tick.
bool Fleet::clear(std::uint32_t row, std::span<const base::Report> reports) const {
  const Outline& outline = outlines_[row];
  if (outline.edges.empty()) return true;
  const Pose& X_WM = reports[row].X_WM;
  const Vec2 p = origin(X_WM);
  const double radius = outline.radius + reach_.own;
  const bool wall_near = walls_.any(world::box_around(p, radius), [&](const Segment& wall) {
    return wall.z_min < X_WM.z + outline.z_max && X_WM.z + outline.z_min < wall.z_max &&
           world::distance(p, wall.a, wall.b) <= radius;
  });
  if (wall_near) return false;
  return !neighbours_.any(p, radius + widest_ + reach_.others, [&](std::uint32_t other) {
    if (other == row || gone_[other] != 0 || outlines_[other].edges.empty()) return false;
    const Vec2 d = origin(reports[other].X_WM) - p;
    const double apart = radius + outlines_[other].radius;
    return dot(d, d) <= apart * apart;
  });
}

bool Fleet::refused(std::uint32_t row, const Pose& X_WM) {
  const Placed next = place(outlines_[row], X_WM, next_);
  const bool by_wall = walls_.any(world::box_around(next.origin, next.radius),
                                  [&](const Segment& wall) { return touches(next, wall) && !leaves(row, X_WM, wall); });
  if (by_wall) return true;
  return neighbours_.any(next.origin, next.radius + widest_ + reach_.others, [&](std::uint32_t row_other) {
    if (row_other == row || gone_[row_other] != 0) return false;
    const Vec2 d = origin(reports_[row_other].X_WM) - next.origin;
    const double apart = next.radius + outlines_[row_other].radius;
    if (dot(d, d) > apart * apart * (1.0 + 1e-12)) return false;
    const Placed other = place(outlines_[row_other], reports_[row_other].X_WM, other_);
    return touches(next, other) && !leaves(row, X_WM, other);
  });
}

bool Fleet::leaves(std::uint32_t row, const Pose& X_WM, const Segment& wall) {
  const Placed now = place(outlines_[row], reports_[row].X_WM, now_);
  return touches(now, wall) &&
         no_nearer(world::distance(origin(X_WM), wall.a, wall.b), world::distance(now.origin, wall.a, wall.b));
}

bool Fleet::leaves(std::uint32_t row, const Pose& X_WM, const Placed& other) {
  const Placed now = place(outlines_[row], reports_[row].X_WM, now_);
  return touches(now, other) && no_nearer(length(origin(X_WM) - other.origin), length(now.origin - other.origin));
}

Fleet::Touch Fleet::touch_of(std::uint32_t row, std::span<const base::Report> reports) {
  const Outline& outline = outlines_[row];
  const Pose& X_WM = reports[row].X_WM;
  const Vec2 p = origin(X_WM);
  const double reach = outline.radius + kPressed;
  Touch touch;
  walls_.any(world::box_around(p, reach), [&](const Segment& wall) {
    const std::uint32_t sectors = sectors_touched(outline, X_WM, wall);
    if (sectors != 0) touch = {touch.sectors | sectors, touch.away + unit(world::from_segment(p, wall.a, wall.b))};
    return false;
  });
  neighbours_.any(p, reach + widest_ + reach_.others, [&](std::uint32_t other) {
    const Vec2 from_other = p - origin(reports[other].X_WM);
    const double apart = reach + outlines_[other].radius;
    if (other == row || gone_[other] != 0 || dot(from_other, from_other) > apart * apart) return false;
    const std::uint32_t sectors = sectors_touched(outline, X_WM, outlines_[other], reports[other].X_WM);
    if (sectors == 0) return false;
    touch = {touch.sectors | sectors, touch.away + unit(from_other)};
    if (refused_[row] != 0) struck_[other] = 1;
    // A mover placed from outside needs its contact sectors alone: in a crowd at one place, all are found soon.
    return told_[row] != 0 && touch.sectors == kEverywhere;
  });
  return touch;
}

}  // namespace sf::robots
