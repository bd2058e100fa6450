#include "sensors/mover_trails.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "base/elementary.h"
#include "base/error.h"

namespace sf::sensors {

MoverTrails::MoverTrails(const world::World& world, std::span<const base::Report> states, std::int64_t duration)
    : world_(world), states_(states), copies_(world), duration_(duration) {
  if (duration == 0) return;
  const double seconds = 1e-9 * static_cast<double>(duration), ticks = std::ceil(seconds / world.interval) + 2.0;
  if (ticks * static_cast<double>(world.movers.size()) > kMostTrailStates)
    throw base::InputError(
        world.file, 0,
        fmt::format("rolling scans of {:g} s need the poses of {} movers in the last {:g} ticks; expected at most {:g} "
                    "poses in all: shorten 'scan_time', or run fewer robots",
                    seconds, world.movers.size(), ticks, kMostTrailStates));
  for (const world::Mover& mover : world.movers) trails_.emplace_back(duration, mover.max_forward);
  last_.resize(trails_.size());
}

base::Report MoverTrails::now(std::uint32_t mover) const {
  base::Report state = states_[mover];
  state.time = now_;
  return state;
}

void MoverTrails::add(std::int64_t time, bool between) {
  now_ = time;
  for (std::uint32_t m = 0; m < trails_.size(); ++m) {
    last_[m] = now(m);
    if (!between) trails_[m].add(last_[m]);
  }
}

void MoverTrails::restart(std::uint32_t mover, std::int64_t time) {
  now_ = time;
  if (empty()) return;
  const auto [first, end] = copies_.rows_with(mover, static_cast<std::uint32_t>(trails_.size()));
  for (std::uint32_t m = first; m < end; ++m) {
    trails_[m].clear();
    last_[m] = now(m);
    trails_[m].add(last_[m]);
  }
}

void MoverTrails::take_over(MoverTrails& before) {
  for (std::size_t m = 0; m < before.trails_.size(); ++m) trails_[m].take_over(before.trails_[m]);
  std::ranges::copy(before.last_, last_.begin());
}

bool MoverTrails::any_moves(std::uint32_t mover, std::int64_t time, double range) const {
  if (!at_rest(mover, time)) return true;
  const base::Pose& here = states_[mover].X_WM;
  const auto [first, end] = copies_.rows_with(mover, static_cast<std::uint32_t>(trails_.size()));
  for (std::uint32_t m = first; m < end; ++m) {
    const base::Pose& there = states_[m].X_WM;
    const double distance = base::hypot(there.x - here.x, there.y - here.y);  // NaN of absent movers
    if (!at_rest(m, time) && distance <= range + world_.movers[m].radius + reach(m)) return true;
  }
  return false;
}

base::RigidTransform MoverTrails::X_WM(std::uint32_t mover, std::int64_t time) const {
  const base::Report state = trails_[mover].at(time, now(mover));
  return base::transform_of(state.X_WM, state.tilt);
}

void MoverTrails::write(std::uint32_t mover, base::ByteWriter& out) const {
  if (empty()) return;
  std::vector<std::uint32_t> moved;
  const auto [first, end] = copies_.rows_with(mover, static_cast<std::uint32_t>(trails_.size()));
  for (std::uint32_t m = first; m < end; ++m)
    if (!base::is_absent(states_[m].X_WM) && !at_rest(m, now_ - duration_)) moved.push_back(m);
  out.put(static_cast<std::uint32_t>(moved.size()));
  for (const std::uint32_t m : moved) {
    out.put(m);
    trails_[m].write(out);
  }
}

void MoverTrails::read(base::ByteReader& in) {
  if (empty()) return;
  for (auto count = in.get<std::uint32_t>(); count > 0 && in.good(); --count) {
    const auto mover = in.get<std::uint32_t>();
    SF_CHECK(mover < trails_.size(), "the trail of mover " + std::to_string(mover));
    MoverTrail &trail = trails_[mover], other = trail;
    other.read(in);
    if (other.is_longer(trail)) trail = std::move(other);
  }
}

}  // namespace sf::sensors
