#include "netio/nearby.h"

#include <algorithm>
#include <tuple>

namespace sf::netio {

namespace {

bool before(const Nearby::Place& a, const Nearby::Place& b) { return std::tie(a.p.x, a.row) < std::tie(b.p.x, b.row); }

}  // namespace

Nearby::Nearby(std::size_t capacity) {
  places_.reserve(capacity);
  found_.reserve(kMostLooks + 1);
  rows_.reserve(kMostLooks + 1);
}

void Nearby::build(std::span<const Place> places) {
  places_.assign(places.begin(), places.end());
  std::sort(places_.begin(), places_.end(), before);
}

void Nearby::look(const Place& place, base::Vec2 p, double square, std::size_t most) {
  const auto nearer = [](const Found& a, const Found& b) {
    return std::tie(a.square, a.row) < std::tie(b.square, b.row);
  };
  const base::Vec2 d = place.p - p;
  const Found found{dot(d, d), place.row};
  if (!(found.square <= square) || (found_.size() == most && !nearer(found, found_.front()))) return;
  found_.push_back(found);
  std::push_heap(found_.begin(), found_.end(), nearer);
  if (found_.size() <= most) return;
  std::pop_heap(found_.begin(), found_.end(), nearer);
  found_.pop_back();
}

std::span<const std::uint32_t> Nearby::find(const std::optional<base::Vec2>& p, std::uint32_t own, double range,
                                            std::size_t most) {
  found_.clear();
  rows_.clear();
  if (!p) {
    for (std::size_t k = 0; k < places_.size() && rows_.size() < most; ++k, ++turn_)
      if (places_[turn_ % places_.size()].row != own) rows_.push_back(places_[turn_ % places_.size()].row);
  } else {
    // Outwards along x on both sides, until whatever is left is too far away.
    auto right = static_cast<std::ptrdiff_t>(std::lower_bound(places_.begin(), places_.end(), Place{*p, own}, before) -
                                             places_.begin());
    std::ptrdiff_t left = right - 1;
    const auto count = static_cast<std::ptrdiff_t>(places_.size());
    const auto aside = [&](std::ptrdiff_t i) {
      const double d = i < 0 || i >= count ? range : places_[static_cast<std::size_t>(i)].p.x - p->x;
      return i < 0 || i >= count ? 4.0 * range * range + 1.0 : d * d;
    };
    for (std::size_t looks = 0; looks < kMostLooks && most > 0; ++looks) {
      std::ptrdiff_t& next = aside(right) <= aside(left) ? right : left;
      const double least = aside(next);
      if (least > range * range || (found_.size() == most && least > found_.front().square)) break;
      const Place& place = places_[static_cast<std::size_t>(next)];
      &next == &right ? ++right : --left;
      if (place.row != own) look(place, *p, range * range, most);
    }
    for (const Found& found : found_) rows_.push_back(found.row);
  }
  std::sort(rows_.begin(), rows_.end());
  return rows_;
}

}  // namespace sf::netio
