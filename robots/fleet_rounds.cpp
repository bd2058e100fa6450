// The rounds of a fleet's tick: proposes paths of movers and rejects some of them.

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/elementary.h"
#include "robots/command_law.h"
#include "robots/fleet.h"
#include "robots/fleet_rules.h"
#include "robots/kinematics.h"
#include "robots/motion_limits.h"

namespace sf::robots {

using base::Twist;

namespace {

Twist times(const Twist& v, double factor) { return {factor * v.forward, factor * v.left, factor * v.turn}; }

}  // namespace

/// Returns the velocity in this tick of a mover without dynamics.
Twist Fleet::velocity_for(std::uint32_t row, const Twist& wanted, double seconds) const {
  const world::Variation variation = world_.variation_of(row);
  const double grip = 1.0 - variation.slip;
  const Twist rolled = limit_acceleration(world_.movers[row], times(reports_[row].velocity, 1.0 / grip), wanted,
                                          variation.acceleration * seconds);
  return times(rolled, grip);
}

void Fleet::start(std::uint32_t row, const Twist& command, double seconds, Scratch& scratch) {
  waiting_[row] = moved_[row] = 0;
  nearby_[row].count = world::kNone;
  if (absent_[row] != 0) {
    progress_[row] = proposed_[row] = {reports_[row].X_WM, {}, 0.0, false};
    return;
  }
  if (!ground_.is_flat()) starts_[row] = reports_[row].X_WM;
  const world::Mover& mover = world_.movers[row];
  const Footprint& outline = footprints_[row];
  const Twist wanted = limit_kinematics(mover, apply_actuator_model(mover, command));
  const Twist v = is_dynamic(row) ? move_body(row, wanted, seconds) : velocity_for(row, wanted, seconds);
  progress_[row] = proposed_[row] = {reports_[row].X_WM, v, moves(v) ? seconds : 0.0, false};
  waiting_[row] = moves(v) ? 1 : 0;
  reported_[row] = 0;

  const double rim = std::abs(v.turn) * outline.radius * seconds;
  double travel = base::hypot(v.forward, v.left) * seconds;
  // A turning mover may push itself off once per substep.
  if (v.turn != 0.0 && !outline.edges.empty())
    travel += kMaxYield * (std::ceil((travel + rim) / outline.step) + kRounds);
  travels_[row] = travel;
  scratch.farthest = std::max(scratch.farthest, travel);
}

void Fleet::run_round(bool last) {
  for_rows(round_rows_.size(), [&](std::uint32_t i, Scratch& scratch) { propose(round_rows_[i], last, scratch); });
  for_rows(round_rows_.size(), [&](std::uint32_t i, Scratch& scratch) {
    yielded_[round_rows_[i]] = yields(round_rows_[i], last, scratch) ? 1 : 0;
  });
  for_rows(round_rows_.size(), [&](std::uint32_t i, Scratch&) { commit(round_rows_[i]); });
}

void Fleet::propose(std::uint32_t row, bool last, Scratch& scratch) {
  if (nearby_[row].count == world::kNone) list_nearby(row);
  find_near(row, scratch);
  find_free_disc(row);
  proposed_[row] = advance_mover(row, last, scratch);
  proposed_[row].exposed =
      std::any_of(scratch.near.begin(), scratch.near.end(), [&](std::uint32_t other) { return waiting_[other] != 0; });
}

/// Tests the same path again with the new places of priority_movers.
bool Fleet::yields(std::uint32_t row, bool last, Scratch& scratch) {
  if (!proposed_[row].exposed || !moved(row)) return false;
  find_near(row, scratch);
  const double reach = reach_of(row);
  for (const std::uint32_t other : scratch.near)
    if (rank_[other] < rank_[row] && moved(other) &&
        comes_near(row, progress_[row].X_WM, reach, other, proposed_[other].X_WM))
      scratch.priority_movers.push_back(other);
  if (scratch.priority_movers.empty()) return false;
  if (proposed_[row].free) return meets_priority_movers_freely(row, scratch);
  advance_mover(row, last, scratch);
  return scratch.yields ||
         meets_priority_mover(row, progress_[row].X_WM,
                              place_footprint(footprints_[row], proposed_[row].X_WM, scratch.next), scratch);
}

bool Fleet::meets_priority_movers_freely(std::uint32_t row, Scratch& scratch) const {
  const Progress& from = progress_[row];
  const double steps = std::ceil(sweep_of(row) / footprints_[row].step);
  for (double k = 1.0; k < steps && !scratch.yields; k += 1.0) {
    const base::Pose X_WM = advance(from.X_WM, from.velocity, k / steps * from.left);
    meets_priority_mover(row, from.X_WM, place_footprint(footprints_[row], X_WM, scratch.next), scratch);
  }
  return meets_priority_mover(row, from.X_WM, place_footprint(footprints_[row], proposed_[row].X_WM, scratch.next),
                              scratch);
}

bool Fleet::moved(std::uint32_t row) const {
  const base::Pose &from = progress_[row].X_WM, &to = proposed_[row].X_WM;
  return from.x != to.x || from.y != to.y || from.yaw != to.yaw;
}

void Fleet::commit(std::uint32_t row) {
  changed_[row] = yielded_[row] != 0 || moved(row) ? 1 : 0;
  if (yielded_[row] != 0) {
    proposed_[row] = progress_[row];
  } else {
    moved_[row] |= changed_[row];
    progress_[row] = proposed_[row];
  }
  reports_[row].X_WM = progress_[row].X_WM;
  waiting_[row] = progress_[row].left > 0.0 ? 1 : 0;
}

/// Finds the movers with an unfinished tick and a change near them.
void Fleet::find_next() {
  std::erase_if(unfinished_, [&](std::uint32_t row) { return waiting_[row] == 0; });
  for_rows(unfinished_.size(), [&](std::uint32_t i, Scratch& scratch) {
    const std::uint32_t row = unfinished_[i];
    find_near(row, scratch);
    const auto stirs = [&](std::uint32_t other) { return changed_[other] != 0; };
    continues_[row] = stirs(row) || std::any_of(scratch.near.begin(), scratch.near.end(), stirs) ? 1 : 0;
  });
  for (const std::uint32_t row : round_rows_) changed_[row] = 0;
  round_rows_.clear();
  for (const std::uint32_t row : unfinished_)
    if (continues_[row] != 0) round_rows_.push_back(row);
}

/// Called before the first round.
void Fleet::list_nearby(std::uint32_t row) {
  constexpr double kMargin = 1e-6;  // [m] for rounding
  Nearby& listed = nearby_[row];
  listed.count = 0;
  if (footprints_[row].edges.empty()) return;
  const base::Pose& X_WM = reports_[row].X_WM;
  const double sweep = reach_of(row) + travels_[row] + kContactDistance + kMargin;
  const auto add = [&](std::uint32_t other) {
    if (other == row || absent_[other] != 0 ||
        !comes_near(row, X_WM, sweep + 2.0 * travels_[other], other, reports_[other].X_WM))
      return false;
    if (listed.count < Nearby::kMost) listed.rows[listed.count] = other;
    return ++listed.count > Nearby::kMost;
  };
  neighbours_.any({X_WM.x, X_WM.y}, footprints_[row].radius + sweep + widest_ + 2.0 * farthest_, add,
                  copies_.copy_of(row));
}

void Fleet::find_near(std::uint32_t row, Scratch& scratch) const {
  scratch.near.clear();
  scratch.priority_movers.clear();
  scratch.yields = false;
  const double sweep = reach_of(row);
  const glm::dvec2 p{reports_[row].X_WM.x, reports_[row].X_WM.y};
  const auto add = [&](std::uint32_t other) {
    if (other != row && absent_[other] == 0 &&
        comes_near(row, reports_[row].X_WM, sweep + travels_[other], other, reports_[other].X_WM))
      scratch.near.push_back(other);
    return false;
  };
  any_nearby(row, p, footprints_[row].radius + sweep + widest_ + 2.0 * farthest_, add);
}

}  // namespace sf::robots
