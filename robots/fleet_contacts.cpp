// Motion of one mover of a fleet: its approach to obstacles, and its contacts.

#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/elementary.h"
#include "robots/fleet.h"
#include "robots/fleet_rules.h"
#include "robots/kinematics.h"

namespace sf::robots {

namespace {

using base::Pose;
using base::Twist;
using world::Segment;

constexpr double kWhole = 0x1p40;          // fixed point: sums of integers do not depend on the order
constexpr double kLongestTested = 1024.0;  // [steps] longer paths are tested in pieces
constexpr double kPiece = 64.0;            // [steps] of a piece with obstacles near
static_assert(base::kContactSectors == 32);

glm::dvec2 origin(const Pose& X_WM) { return {X_WM.x, X_WM.y}; }

// Returns whether the mover is no closer to a touched surface than before. Rounding at 100 km is 1.5e-11.
bool no_nearer(double after, double before) { return after >= before - 1e-10; }

glm::dvec2 unit(glm::dvec2 v) {
  const double size = length(v);
  return size > 0.0 ? 1.0 / size * v : glm::dvec2{};
}

}  // namespace

/// Returns true as soon as `visit(wall, distance [m] from the mover's circle)` is true for a wall within about `sweep`.
template <class Visit>
bool Fleet::any_wall(std::uint32_t row, const Pose& X_WM, double sweep, Visit&& visit) const {
  const Footprint& outline = footprints_[row];
  const double radius = outline.radius + sweep;
  const glm::dvec2 p = origin(X_WM);
  return !outline.edges.empty() && walls_.any(world::box_around(p, radius), [&](const Segment& wall) {
    return wall.z_min < X_WM.z + outline.z_max && X_WM.z + outline.z_min < wall.z_max &&
           visit(wall, world::distance(p, wall.a, wall.b) - outline.radius);
  });
}

bool Fleet::clear(std::uint32_t row, std::span<const base::Report> reports, double sweep) const {
  const Pose& X_WM = reports[row].X_WM;
  const double reach = footprints_[row].radius + sweep + widest_ + farthest_;
  return !any_wall(row, X_WM, sweep, [&](const Segment&, double gap) { return gap <= sweep; }) &&
         !neighbours_.any(
             origin(X_WM), reach,
             [&](std::uint32_t other) {
               return other != row && absent_[other] == 0 && comes_near(row, X_WM, sweep, other, reports[other].X_WM);
             },
             copies_.copy_of(row));
}

/// Returns whether a mover's circle that starts at `from` and travels up to `sweep` [m] can meet another mover's
/// circle.
bool Fleet::comes_near(std::uint32_t row, const Pose& from, double sweep, std::uint32_t other, const Pose& X_WO) const {
  if (footprints_[row].edges.empty() || footprints_[other].edges.empty()) return false;
  const glm::dvec2 d = origin(X_WO) - origin(from);
  const double apart = footprints_[row].radius + sweep + footprints_[other].radius;
  return dot(d, d) <= apart * apart;
}

/// [m] Returns the largest travel of any point of the mover in the rest of the tick.
double Fleet::sweep_of(std::uint32_t row) const {
  const Twist& v = progress_[row].velocity;
  return (base::hypot(v.forward, v.left) + std::abs(v.turn) * footprints_[row].radius) * progress_[row].left;
}

/// [m] Returns `sweep_of` plus the largest push-off.
double Fleet::reach_of(std::uint32_t row) const {
  return travels_[row] + std::abs(progress_[row].velocity.turn) * footprints_[row].radius * progress_[row].left;
}

bool Fleet::is_in_free_disc(std::uint32_t row) const {
  constexpr double kMargin = 1e-6;  // [m] for rounding
  const FreeDisc& disc = free_discs_[row];
  const double reach = footprints_[row].radius + reach_of(row);
  return length(origin(progress_[row].X_WM) - disc.centre) + reach + kMargin <= disc.radius;
}

/// Looks farther than this tick needs. Near walls, the first wall found ends the search.
void Fleet::find_free_disc(std::uint32_t row) {
  if (is_in_free_disc(row)) return;
  const Pose& X_WM = progress_[row].X_WM;
  const double radius = footprints_[row].radius, near = radius + reach_of(row);
  double free = 4.0 * near;
  const bool ended = any_wall(row, X_WM, free - radius, [&](const Segment&, double gap) {
    free = std::min(free, gap + radius);
    return free <= near;
  });
  free_discs_[row] = {origin(X_WM), ended ? 0.0 : free};
}

Fleet::Progress Fleet::advance_mover(std::uint32_t row, bool last, Scratch& scratch) const {
  Progress progress = progress_[row];
  const Pose& from = progress_[row].X_WM;
  const double sweep = sweep_of(row), steps = std::max(1.0, std::ceil(sweep / footprints_[row].step));
  if (steps > kLongestTested) return advance_in_pieces(row, steps, last, scratch);
  const auto meets = [&](std::uint32_t other) { return comes_near(row, from, sweep, other, reports_[other].X_WM); };
  progress.free = std::none_of(scratch.near.begin(), scratch.near.end(), meets);
  scratch.walls.clear();
  if (!is_in_free_disc(row))
    any_wall(row, from, reach_of(row), [&](const Segment& wall, double gap) {
      scratch.walls.push_back(&wall);
      progress.free = progress.free && gap > sweep;
      return false;
    });
  if (!progress.free) return advance_in_steps(row, progress, steps, last, scratch);
  progress.X_WM = advance(from, progress.velocity, progress.left);
  progress.left = 0.0;
  return progress;
}

/// Returns whether a piece of a path is far from all obstacles. The path of the origin stays within `bulge` of the
/// straight line from `from` to its end.
bool Fleet::is_free(std::uint32_t row, const Progress& from, double seconds, std::span<const std::uint32_t> others,
                    std::span<const std::uint32_t> rivals) const {
  const Twist& v = from.velocity;
  const double travel = base::hypot(v.forward, v.left) * seconds, turn = std::abs(v.turn) * seconds;
  const glm::dvec2 a = origin(from.X_WM), b = turn < 1.0 ? origin(advance(from.X_WM, v, seconds)) : a;
  const double circle = turn > 0.0 ? 2.0 * travel / turn : 0.0;  // [m] diameter
  const double bulge = 1e-6 + (turn < 1.0 ? 0.25 * turn * travel : std::min(travel, circle));
  const double clear = footprints_[row].radius + bulge;
  const auto meets = [&](std::uint32_t other, const Pose& X_WO) {
    return world::distance(origin(X_WO), a, b) <= clear + footprints_[other].radius;
  };
  return std::none_of(others.begin(), others.end(), [&](auto other) { return meets(other, reports_[other].X_WM); }) &&
         std::none_of(rivals.begin(), rivals.end(), [&](auto rival) { return meets(rival, proposed_[rival].X_WM); }) &&
         !any_wall(row, from.X_WM, travel + bulge, [&](const Segment& wall, double) {
           return world::segments_meet(a, b, wall.a, wall.b) || world::distance(a, wall.a, wall.b) <= clear ||
                  world::distance(b, wall.a, wall.b) <= clear || world::distance(wall.a, a, b) <= clear ||
                  world::distance(wall.b, a, b) <= clear;
         });
}

/// Lists the obstacles within `reach` [m] of the mover.
void Fleet::find_obstacles(std::uint32_t row, const Pose& X_WM, double reach, std::span<const std::uint32_t> others,
                           Scratch& scratch) const {
  scratch.near.clear(), scratch.walls.clear();
  for (const std::uint32_t other : others)
    if (comes_near(row, X_WM, reach, other, reports_[other].X_WM)) scratch.near.push_back(other);
  any_wall(row, X_WM, reach, [&](const Segment& wall, double gap) {
    if (gap <= reach) scratch.walls.push_back(&wall);
    return false;
  });
}

/// Advances along a path of thousands of steps: free pieces at once, the others step by step. A mover that passes
/// obstacles for too many steps ends its tick there.
Fleet::Progress Fleet::advance_in_pieces(std::uint32_t row, double steps, bool last, Scratch& scratch) const {
  Progress progress = progress_[row];
  const double dt = progress.left / steps;
  scratch.all_near = scratch.near;
  const std::span<const std::uint32_t> others = scratch.all_near;
  double tested = 0.0;
  bool waits = false;
  for (double most = kLongestTested; steps > 0.0 && !waits && !scratch.yields && moves(progress.velocity);) {
    const double piece = std::min(most, steps);
    const bool free = is_free(row, progress, piece * dt, others, scratch.priority_movers);
    if (free) {
      progress.X_WM = advance(progress.X_WM, progress.velocity, piece * dt);
      most *= 2.0;
    } else if (piece > kPiece) {
      most = std::max(kPiece, 0.25 * piece);
      continue;
    } else {
      if ((tested += piece) > kMostTested) break;
      const double travel = base::hypot(progress.velocity.forward, progress.velocity.left) * piece * dt;
      find_obstacles(row, progress.X_WM, travel + kMaxYield * (piece + kRounds), others, scratch);
      progress.left = piece * dt;
      progress = advance_in_steps(row, progress, piece, last, scratch);
    }
    steps -= piece;
    waits = !free && progress.left > 0.0;
    if (waits) progress.left += steps * dt;
  }
  if (!waits) progress.left = 0.0;
  scratch.near = scratch.all_near;
  return progress;
}

Fleet::Progress Fleet::advance_in_steps(std::uint32_t row, Progress progress, double steps, bool last,
                                        Scratch& scratch) const {
  const double dt = progress.left / steps;
  double part = dt;  // [s] left of this step
  while (steps > 0.0 && !scratch.yields) {
    ++scratch.tested;
    const Pose X_next = advance(progress.X_WM, progress.velocity, part);
    const Stop stop = stop_at(row, progress.X_WM, X_next, last, scratch);
    if (stop == Stop::none) {
      progress.X_WM = X_next;
      steps -= 1.0, part = dt;
      continue;
    }
    if (stop == Stop::waiting) {
      progress.left = steps * dt - (dt - part);
      return progress;
    }
    progress.refused = true;
    const bool in_place = progress.velocity.forward == 0.0 && progress.velocity.left == 0.0;
    if (in_place) {
      if (turn_in_contact(row, progress, part, last, scratch)) {
        steps -= 1.0, part = dt;
        continue;
      }
    } else {
      part -= advance_to_contact(row, progress, part, last, scratch);
      // The rest of the step is tried as a turn in place.
      if (progress.velocity.turn != 0.0 && world_.movers[row].drive != world::Drive::car) {
        progress.velocity = {0.0, 0.0, progress.velocity.turn};
        continue;
      }
    }
    progress.velocity = {};
    break;
  }
  progress.left = 0.0;
  return progress;
}

// Advances along a refused step up to the obstacle, and returns the time taken [s]. Tries the smallest part first, so a
// mover in contact stays in place.
double Fleet::advance_to_contact(std::uint32_t row, Progress& progress, double dt, bool last, Scratch& scratch) const {
  const Pose X_start = progress.X_WM;
  const auto refused = [&](double part) {
    return stop_at(row, X_start, advance(X_start, progress.velocity, part * dt), last, scratch) != Stop::none;
  };
  const int halvings = halvings_to_gap(footprints_[row].step);
  double free = std::ldexp(1.0, -halvings), blocked = 1.0;
  if (refused(free)) return 0.0;
  for (int k = 0; k < halvings; ++k) {
    const double middle = 0.5 * (free + blocked);
    (refused(middle) ? blocked : free) = middle;
  }
  progress.X_WM = advance(X_start, progress.velocity, free * dt);
  return free * dt;
}

// Turns a mover that is not close enough for a push-off until it is.
bool Fleet::turn_in_contact(std::uint32_t row, Progress& progress, double dt, bool last, Scratch& scratch) const {
  if (push_off(row, progress, dt, last, scratch)) return true;
  const double done = advance_to_contact(row, progress, dt, last, scratch);
  return done > 0.0 && push_off(row, progress, dt - done, last, scratch);
}

// A body that is not exactly round (a disc of sixteen sides) pushes itself off the touched surface when turning.
bool Fleet::push_off(std::uint32_t row, Progress& progress, double dt, bool last, Scratch& scratch) const {
  const glm::dvec2 away = unit(body_contact(row, progress.X_WM, reports_).away);
  if (away.x == 0.0 && away.y == 0.0) return false;
  const Pose X_turned = advance(progress.X_WM, progress.velocity, dt);
  for (const double yield : {0.25 * kMaxYield, 0.5 * kMaxYield, kMaxYield}) {
    Pose X_WM = X_turned;
    X_WM.x += yield * away.x;
    X_WM.y += yield * away.y;
    if (stop_at(row, progress.X_WM, X_WM, last, scratch) != Stop::none) continue;
    progress.X_WM = X_WM;
    return true;
  }
  return false;
}

Fleet::Stop Fleet::stop_at(std::uint32_t row, const Pose& from, const Pose& to, bool last, Scratch& scratch) const {
  const PlacedFootprint next = to.yaw == from.yaw && to.z == from.z
                                   ? place_again(row, to, scratch.now)
                                   : place_footprint(footprints_[row], to, scratch.next);
  for (const Segment* wall : scratch.walls)
    if (touches(next, *wall) && !leaves(row, from, next.origin, *wall, scratch)) return Stop::refused;
  Stop stop = Stop::none;
  for (const std::uint32_t other : scratch.near) {
    if (!is_stopped(row, from, next, other, reports_[other].X_WM, scratch)) continue;
    if (last || waiting_[other] == 0) return Stop::refused;
    stop = Stop::waiting;
  }
  if (stop == Stop::none && meets_priority_mover(row, from, next, scratch)) return Stop::refused;
  return stop;
}

/// Returns `place_footprint`, whose result the memory may still hold.
PlacedFootprint Fleet::place_again(std::uint32_t row, const Pose& X_WM, Placed& memory) const {
  const Footprint& outline = footprints_[row];
  const Pose& X = memory.X_WM;
  if (memory.row == row && X.z == X_WM.z && X.yaw == X_WM.yaw)  // edges are relative to the origin
    return {origin(X_WM), outline.radius, std::span(memory.edges).first(outline.edges.size())};
  memory.row = row, memory.X_WM = X_WM;
  return place_footprint(outline, X_WM, memory.edges);
}

/// Tests priority movers on a path without other obstacles.
bool Fleet::meets_priority_mover(std::uint32_t row, const Pose& from, const PlacedFootprint& next,
                                 Scratch& scratch) const {
  for (const std::uint32_t rival : scratch.priority_movers)
    scratch.yields = scratch.yields || is_stopped(row, from, next, rival, proposed_[rival].X_WM, scratch);
  return scratch.yields;
}

bool Fleet::is_stopped(std::uint32_t row, const Pose& from, const PlacedFootprint& next, std::uint32_t other,
                       const Pose& X_WO, Scratch& scratch) const {
  const glm::dvec2 d = origin(X_WO) - next.origin;
  const double apart = next.radius + footprints_[other].radius;
  if (dot(d, d) > apart * apart * (1.0 + 1e-12)) return false;
  const double after = length(next.origin - origin(X_WO)), before = length(origin(from) - origin(X_WO));
  const bool nearer = !no_nearer(after, before);
  if (surely_overlap(footprints_[row], footprints_[other], nearer ? after : before, X_WO.z - from.z)) return nearer;
  const PlacedFootprint placed = place_again(other, X_WO, scratch.others[other % scratch.others.size()]);
  if (!touches(next, placed)) return false;
  const PlacedFootprint now = place_again(row, from, scratch.now);
  return nearer || !touches(now, placed);
}

/// Returns whether the mover already touches the wall and its origin gets no closer to it.
bool Fleet::leaves(std::uint32_t row, const Pose& from, glm::dvec2 to, const Segment& wall, Scratch& scratch) const {
  const PlacedFootprint now = place_again(row, from, scratch.now);
  return touches(now, wall) &&
         no_nearer(world::distance(to, wall.a, wall.b), world::distance(now.origin, wall.a, wall.b));
}

/// Returns whether a mover surely touches the same sectors as after the last tick: it touched something then, and
/// neither it nor a mover near it has moved. The movers that refused it a step must know of their contacts without it.
bool Fleet::keeps_contacts(std::uint32_t row) const {
  const base::Report& own = reports_[row];
  if (disturbed_ || moved_[row] != 0 || own.contact_mask == 0) return false;
  const double reach = footprints_[row].radius + kContactDistance;
  const auto changes = [&](std::uint32_t other) {
    if (other == row || absent_[other] != 0) return false;
    const glm::dvec2 d = origin(reports_[other].X_WM) - origin(own.X_WM);
    const double apart = reach + travels_[other] + footprints_[other].radius;
    return dot(d, d) <= apart * apart && (moved_[other] != 0 || (refused_[row] != 0 && contacts_[other] == 0));
  };
  return !any_nearby(row, origin(own.X_WM), reach + widest_ + farthest_, changes);
}

Fleet::BodyContact Fleet::body_contact(std::uint32_t row, const Pose& X_WM, std::span<const base::Report> reports,
                                       std::span<std::uint8_t> struck) const {
  const Footprint& outline = footprints_[row];
  const glm::dvec2 p = origin(X_WM);
  const double reach = outline.radius + kContactDistance;
  BodyContact touch;
  std::int64_t x = 0, y = 0;
  const auto add = [&](std::uint32_t sectors, glm::dvec2 from_surface) {
    const glm::dvec2 away = kWhole * unit(from_surface);
    x += std::llround(away.x), y += std::llround(away.y);
    touch.sectors |= sectors;
  };
  walls_.any(world::box_around(p, reach), [&](const Segment& wall) {
    constexpr double kMargin = 1e-6;  // [m] for rounding
    if (world::distance(p, wall.a, wall.b) > reach + kMargin) return false;
    const std::uint32_t sectors = contact_sectors(outline, X_WM, wall);
    if (sectors != 0) add(sectors, world::from_segment(p, wall.a, wall.b));
    return false;
  });
  const auto meet = [&](std::uint32_t other, glm::dvec2 from_other, bool deep) {
    const Footprint& its = footprints_[other];
    const Pose& X_WO = reports[other].X_WM;
    // Only the contact sectors of a mover placed from outside are needed.
    const std::uint32_t wanted =
        reported_[row] != 0 ? sectors_to_test(outline, X_WM, its, X_WO, touch.sectors) : kAllSectors;
    const bool known = deep && touch.sectors == kAllSectors;
    const std::uint32_t sectors = known ? kAllSectors : contact_sectors(outline, X_WM, its, X_WO, wanted);
    if (sectors == 0) return false;
    add(sectors, from_other);
    if (!struck.empty()) std::atomic_ref(struck[other]).store(1, std::memory_order_relaxed);
    return reported_[row] != 0 && touch.sectors == kAllSectors;
  };
  // Movers that overlap deeply come first: in a dense crowd they soon touch all sectors.
  for (const bool deeply : {true, false}) {
    const auto touches = [&](std::uint32_t other) {
      const glm::dvec2 from_other = p - origin(reports[other].X_WM);
      const double apart = reach + footprints_[other].radius;
      if (other == row || absent_[other] != 0 || dot(from_other, from_other) > apart * apart) return false;
      const bool deep = surely_overlap(outline, footprints_[other], length(from_other), reports[other].X_WM.z - X_WM.z);
      const bool first = deep && length(from_other) < 0.5 * outline.inner;
      return first == deeply && meet(other, from_other, deep);
    };
    if (any_nearby(row, p, reach + widest_ + farthest_, touches)) break;
  }
  touch.away = 1.0 / kWhole * glm::dvec2{static_cast<double>(x), static_cast<double>(y)};
  return touch;
}

}  // namespace sf::robots
