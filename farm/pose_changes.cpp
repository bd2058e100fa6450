#include "farm/pose_changes.h"

#include <algorithm>
#include <array>
#include <bit>

#include "base/report.h"

namespace sf::farm {

namespace {

/// Number of places searched before they are sorted. In a crowd one of them is usually within reach, so that no tick
/// needs the order.
constexpr std::ptrdiff_t kProbed = 256;

/// Compares bitwise, since the sign of a zero may affect a reading.
bool same(const base::Pose& p, const base::Pose& q) {
  using Bits = std::array<std::uint64_t, 4>;
  static_assert(sizeof(base::Pose) == sizeof(Bits));
  return std::bit_cast<Bits>(p) == std::bit_cast<Bits>(q);
}

}  // namespace

PoseChanges::PoseChanges(const world::World& world)
    : world_(world), copies_(world), flags_(world.movers.size(), false) {
  moved_.reserve(world.movers.size());
  places_.reserve(2 * world.movers.size());
  for (const world::Mover& mover : world.movers) largest_ = std::max(largest_, mover.radius);
}

void PoseChanges::begin() {
  for (const std::uint32_t mover : moved_) flags_[mover] = false;
  moved_.clear();
  places_.clear();
  magnets_ = false;
  sorted_ = true;
}

void PoseChanges::add(std::uint32_t mover, const base::Pose& from, const base::Pose& to, bool tilted) {
  if (same(from, to) && !tilted) return;
  const world::Mover& who = world_.movers[mover];
  moved_.push_back(mover);
  flags_[mover] = true;
  magnets_ = magnets_ || !who.magnets.empty();
  if (who.body.empty()) return;
  for (const base::Pose& X : {from, to})
    if (!base::is_absent(X)) places_.push_back({X.x, X.y, who.radius, copies_.copy_of(mover)});
  sorted_ = false;
}

bool PoseChanges::within(std::uint32_t mover, glm::dvec2 p, double reach) {
  const std::uint32_t copy = copies_.copy_of(mover);
  const auto is_within = [&](const Place& at) {
    return at.copy == copy && glm::length(glm::dvec2{at.x, at.y} - p) <= reach + at.radius;
  };
  if (!sorted_ && std::any_of(places_.begin(), places_.begin() + std::min(kProbed, std::ssize(places_)), is_within))
    return true;
  if (!sorted_) std::ranges::sort(places_, {}, &Place::order);
  sorted_ = true;
  const double most = reach + largest_;
  auto at = std::ranges::lower_bound(places_, std::pair(copy, p.x - most), {}, &Place::order);
  for (; at != places_.end() && at->order() <= std::pair(copy, p.x + most); ++at)
    if (is_within(*at)) return true;
  return false;
}

}  // namespace sf::farm
