// The rounds of a fleet's tick: which way each mover proposes, and which of these ways are gone.

#include <algorithm>
#include <cmath>
#include <vector>

#include "robots/command_law.h"
#include "robots/fleet.h"
#include "robots/motion.h"

namespace sf::robots {

namespace {

using base::Twist;

bool moves(const Twist& v) { return v.forward != 0.0 || v.left != 0.0 || v.turn != 0.0; }

}  // namespace

void Fleet::start(std::uint32_t row, const Twist& command, double seconds, Scratch& scratch) {
  const world::Mover& mover = world_.movers[row];
  const Outline& outline = outlines_[row];
  const Twist wanted = follow(mover, obey(mover, command));
  const Twist v = approach(mover, reports_[row].velocity, wanted, seconds);
  ways_[row] = proposed_[row] = {reports_[row].X_WM, v, moves(v) ? seconds : 0.0, false};
  waiting_[row] = moves(v) ? 1 : 0;
  told_[row] = 0;

  const double rim = std::abs(v.turn) * outline.radius * seconds;
  double travel = std::hypot(v.forward, v.left) * seconds;
  // A mover that turns may push itself off, once a substep.
  if (v.turn != 0.0 && !outline.edges.empty())
    travel += kMostYield * (std::ceil((travel + rim) / outline.step) + kRounds);
  travels_[row] = travel;
  scratch.farthest = std::max(scratch.farthest, travel);
}

void Fleet::run_round(bool last) {
  for_rows(round_.size(), [&](std::uint32_t i, Scratch& scratch) { propose(round_[i], last, scratch); });
  for_rows(round_.size(),
           [&](std::uint32_t i, Scratch& scratch) { beaten_[round_[i]] = beaten(round_[i], last, scratch) ? 1 : 0; });
  for_rows(round_.size(), [&](std::uint32_t i, Scratch&) { commit(round_[i]); });
}

void Fleet::propose(std::uint32_t row, bool last, Scratch& scratch) {
  find_near(row, scratch);
  proposed_[row] = go(row, last, scratch);
  proposed_[row].exposed =
      std::any_of(scratch.near.begin(), scratch.near.end(), [&](std::uint32_t other) { return waiting_[other] != 0; });
}

/// The same way again, with the places of rivals in it.
bool Fleet::beaten(std::uint32_t row, bool last, Scratch& scratch) {
  if (!proposed_[row].exposed || !moved(row)) return false;
  find_near(row, scratch);
  const double reach = reach_of(row);
  for (const std::uint32_t other : scratch.near)
    if (rank_[other] < rank_[row] && moved(other) &&
        comes_near(row, ways_[row].X_WM, reach, other, proposed_[other].X_WM))
      scratch.rivals.push_back(other);
  if (scratch.rivals.empty()) return false;
  if (proposed_[row].free) return meets_rivals_freely(row, scratch);
  go(row, last, scratch);
  return scratch.beaten ||
         meets_rival(row, ways_[row].X_WM, place(outlines_[row], proposed_[row].X_WM, scratch.next), scratch);
}

bool Fleet::meets_rivals_freely(std::uint32_t row, Scratch& scratch) const {
  const Way& from = ways_[row];
  const double steps = std::ceil(sweep_of(row) / outlines_[row].step);
  for (double k = 1.0; k < steps && !scratch.beaten; k += 1.0) {
    const base::Pose X_WM = advance(from.X_WM, from.velocity, k / steps * from.left);
    meets_rival(row, from.X_WM, place(outlines_[row], X_WM, scratch.next), scratch);
  }
  return meets_rival(row, from.X_WM, place(outlines_[row], proposed_[row].X_WM, scratch.next), scratch);
}

bool Fleet::moved(std::uint32_t row) const {
  const base::Pose &from = ways_[row].X_WM, &to = proposed_[row].X_WM;
  return from.x != to.x || from.y != to.y || from.yaw != to.yaw;
}

void Fleet::commit(std::uint32_t row) {
  stirred_[row] = beaten_[row] != 0 || moved(row) ? 1 : 0;
  if (beaten_[row] != 0)
    proposed_[row] = ways_[row];
  else
    ways_[row] = proposed_[row];
  reports_[row].X_WM = ways_[row].X_WM;
  waiting_[row] = ways_[row].left > 0.0 ? 1 : 0;
}

/// Movers whose tick is not over, and near whom something changed.
void Fleet::find_next() {
  std::erase_if(open_, [&](std::uint32_t row) { return waiting_[row] == 0; });
  for_rows(open_.size(), [&](std::uint32_t i, Scratch& scratch) {
    const std::uint32_t row = open_[i];
    find_near(row, scratch);
    const auto stirs = [&](std::uint32_t other) { return stirred_[other] != 0; };
    goes_on_[row] = stirs(row) || std::any_of(scratch.near.begin(), scratch.near.end(), stirs) ? 1 : 0;
  });
  for (const std::uint32_t row : round_) stirred_[row] = 0;
  round_.clear();
  for (const std::uint32_t row : open_)
    if (goes_on_[row] != 0) round_.push_back(row);
}

void Fleet::find_near(std::uint32_t row, Scratch& scratch) const {
  scratch.near.clear();
  scratch.rivals.clear();
  scratch.beaten = false;
  const double sweep = reach_of(row);
  const glm::dvec2 p{reports_[row].X_WM.x, reports_[row].X_WM.y};
  neighbours_.any(p, outlines_[row].radius + sweep + widest_ + 2.0 * farthest_, [&](std::uint32_t other) {
    if (other != row && gone_[other] == 0 &&
        comes_near(row, reports_[row].X_WM, sweep + travels_[other], other, reports_[other].X_WM))
      scratch.near.push_back(other);
    return false;
  });
}

}  // namespace sf::robots
