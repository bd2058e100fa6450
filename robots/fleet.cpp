#include "robots/fleet.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "robots/motion.h"

namespace sf::robots {

namespace {

using base::Pose;
using base::Twist;
using base::Vec2;
using world::Segment;

Vec2 origin(const Pose& X_WM) { return {X_WM.x, X_WM.y}; }

bool moves(const Twist& v) { return v.forward != 0.0 || v.left != 0.0 || v.turn != 0.0; }

std::vector<Outline> outlines_of(const world::World& world) {
  std::vector<Outline> outlines;
  for (const world::Mover& mover : world.movers) outlines.push_back(outline_of(mover));
  return outlines;
}

std::vector<Segment> stopping(const world::World& world) {
  std::vector<Segment> walls;
  std::copy_if(world.walls.begin(), world.walls.end(), std::back_inserter(walls),
               [](const Segment& wall) { return wall.stops_robots; });
  return walls;
}

double median_radius(const std::vector<Outline>& outlines) {
  std::vector<double> radii;
  for (const Outline& outline : outlines) radii.push_back(outline.radius);
  if (radii.empty()) return 1.0;
  std::nth_element(radii.begin(), radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2), radii.end());
  return std::clamp(radii[radii.size() / 2], 0.05, 10.0);
}

// Not nearer to what was touched already; rounding at 100 km is 1.5e-11.
bool no_nearer(double after, double before) { return after >= before - 1e-10; }

}  // namespace

Fleet::Fleet(const world::World& world)
    : world_(world), outlines_(outlines_of(world)), walls_(stopping(world), 2.0 * median_radius(outlines_)) {
  const std::size_t count = world.movers.size();
  std::size_t edges = 0;
  for (std::uint32_t row = 0; row < count; ++row) {
    reports_.push_back({.mover = row, .time = 0, .X_WM = world.movers[row].X_WM, .velocity = {}});
    widest_ = std::max(widest_, outlines_[row].radius);
    edges = std::max(edges, outlines_[row].edges.size());
  }
  predicted_ = reports_;
  velocities_.resize(count);
  contacts_.resize(count);
  for (auto* memory : {&next_, &now_, &other_}) memory->resize(edges);
  neighbours_.build(reports_, 1.0);
}

void Fleet::move(std::span<const Twist> commands, std::int64_t dt) {
  SF_CHECK(commands.size() == reports_.size(), std::to_string(commands.size()) + " commands");
  SF_CHECK(dt > 0, "dt " + std::to_string(dt));
  const double seconds = 1e-9 * static_cast<double>(dt);

  reach_ = {0.0, 0.0};
  for (std::size_t row = 0; row < commands.size(); ++row) {
    velocities_[row] = follow(world_.movers[row], commands[row]);
    reach_.others = std::max(reach_.others, std::hypot(velocities_[row].forward, velocities_[row].left) * seconds);
  }
  neighbours_.build(reports_, 4.0 * (widest_ + reach_.others) + 1e-3);

  for (std::uint32_t row = 0; row < reports_.size(); ++row) {
    contacts_[row] = 0;
    move_one(row, velocities_[row], seconds);
    reports_[row].time += dt;
  }
}

void Fleet::move_one(std::uint32_t row, const Twist& velocity, double dt) {
  reports_[row].velocity = velocity;
  if (!moves(velocity)) return;
  const Outline& outline = outlines_[row];
  reach_.own = (std::hypot(velocity.forward, velocity.left) + std::abs(velocity.turn) * outline.radius) * dt;
  if (clear(row)) {
    reports_[row].X_WM = advance(reports_[row].X_WM, velocity, dt);
    return;
  }
  const auto steps = static_cast<std::int64_t>(std::ceil(reach_.own / outline.step));
  move_in_steps(row, velocity, dt / static_cast<double>(steps), steps);
}

void Fleet::move_in_steps(std::uint32_t row, Twist velocity, double dt, std::int64_t steps) {
  for (std::int64_t i = 0; i < steps; ++i) {
    if (step(row, velocity, dt)) continue;
    contacts_[row] = 1;
    const bool in_place = velocity.forward == 0.0 && velocity.left == 0.0;
    velocity = {0.0, 0.0, world_.movers[row].drive == world::Drive::car ? 0.0 : velocity.turn};
    if (in_place || velocity.turn == 0.0 || !step(row, velocity, dt)) {
      velocity = {};
      break;
    }
  }
  reports_[row].velocity = velocity;
}

bool Fleet::step(std::uint32_t row, const Twist& velocity, double dt) {
  const Pose X_WM = advance(reports_[row].X_WM, velocity, dt);
  if (refused(row, X_WM)) return false;
  reports_[row].X_WM = X_WM;
  return true;
}

// Nothing within the circle that holds all the mover can sweep this tick.
bool Fleet::clear(std::uint32_t row) const {
  const Outline& outline = outlines_[row];
  if (outline.edges.empty()) return true;
  const Pose& X_WM = reports_[row].X_WM;
  const Vec2 p = origin(X_WM);
  const double radius = outline.radius + reach_.own;
  const bool wall_near = walls_.any(world::box_around(p, radius), [&](const Segment& wall) {
    return wall.z_min < X_WM.z + outline.z_max && X_WM.z + outline.z_min < wall.z_max &&
           world::distance(p, wall.a, wall.b) <= radius;
  });
  if (wall_near) return false;
  return !neighbours_.any(p, radius + widest_ + reach_.others, [&](std::uint32_t other) {
    if (other == row || outlines_[other].edges.empty()) return false;
    const Vec2 d = origin(reports_[other].X_WM) - p;
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
    if (row_other == row) return false;
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

std::size_t Fleet::apply(std::span<const base::Report> reports) {
  std::size_t taken = 0;
  for (const base::Report& report : reports) {
    SF_CHECK(report.mover < reports_.size(), "mover " + std::to_string(report.mover));
    if (report.time < reports_[report.mover].time) continue;
    reports_[report.mover] = report;
    ++taken;
  }
  return taken;
}

std::span<const base::Report> Fleet::predict(std::int64_t time) {
  for (std::size_t row = 0; row < reports_.size(); ++row) {
    const base::Report& known = reports_[row];
    predicted_[row] = known;
    const std::int64_t ahead = std::clamp<std::int64_t>(time - known.time, 0, kCoast);
    if (ahead == 0) continue;
    predicted_[row].time = known.time + ahead;
    predicted_[row].X_WM = advance(known.X_WM, known.velocity, 1e-9 * static_cast<double>(ahead));
  }
  return predicted_;
}

}  // namespace sf::robots
