#include "raycast/depth.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

namespace sf::raycast {

namespace {

constexpr double kCutOff = 1.0;  ///< [m]

}  // namespace

Depth::Depth(const Sight& sight, std::size_t most_points) : sight_(sight) {
  if (sight.segments().empty()) return;
  low_ = sight.low();
  const Vec2 size = sight.high() - low_;
  spacing_ = std::max(0.05, std::sqrt(size.x * size.y / static_cast<double>(most_points)));
  per_spacing_ = 1.0 / spacing_;
  columns_ = static_cast<int>(std::min(size.x / spacing_, 1e6)) + 2;
  rows_ = static_cast<int>(std::min(size.y / spacing_, 1e6)) + 2;
  if (static_cast<double>(columns_) * rows_ > 4.0 * static_cast<double>(most_points)) columns_ = rows_ = 0;
  signed_.resize(static_cast<std::size_t>(columns_) * rows_, std::numeric_limits<float>::quiet_NaN());
}

float Depth::measure(Vec2 p, Sight::Nearby& scratch) const {
  double least = kCutOff;
  for (const double radius : {0.125 * kCutOff, kCutOff}) {
    sight_.near(p, radius, scratch);
    for (const std::uint32_t i : scratch.found)
      least = std::min(least, world::distance(p, sight_.segments()[i].a, sight_.segments()[i].b));
    if (least <= radius) break;  // what was not found is farther
  }
  const bool inside = least > 1e-6 && sight_.inside_solid(p);
  return static_cast<float>(inside ? -least : least);
}

bool Depth::is_on_grid(Vec2 q) const {
  return q.x >= low_.x && q.y >= low_.y && q.x <= low_.x + (columns_ - 1) * spacing_ &&
         q.y <= low_.y + (rows_ - 1) * spacing_;
}

float Depth::at(Vec2 q, Sight::Nearby& scratch) const {
  const Vec2 nearest = per_spacing_ * (q - low_) + Vec2{0.5, 0.5};
  const int column = static_cast<int>(std::clamp(nearest.x, 0.0, columns_ - 1.0));
  const int row = static_cast<int>(std::clamp(nearest.y, 0.0, rows_ - 1.0));
  // Two threads may measure one point: they find the same.
  const std::atomic_ref known(signed_[static_cast<std::size_t>(row) * columns_ + column]);
  const float found = known.load(std::memory_order_relaxed);
  if (!std::isnan(found)) return found;
  const float measured = measure(low_ + Vec2{column * spacing_, row * spacing_}, scratch);
  known.store(measured, std::memory_order_relaxed);
  return measured;
}

bool Depth::hides(Vec2 origin, double origin_radius, Vec2 p, double radius, Sight::Nearby& scratch) const {
  if (signed_.empty()) return false;
  const double distance = length(p - origin);
  const double end = distance - radius;
  const Vec2 along = (1.0 / distance) * (p - origin);
  const double widening = (radius - origin_radius) / distance;
  const double off = 0.7072 * spacing_;
  for (double s = origin_radius; s < end;) {
    // Depth grows by at most a metre per metre: what is missing tells how far to go.
    const Vec2 q = origin + s * along;
    const double here = is_on_grid(q) ? at(q, scratch) : kCutOff;
    const double wide = 1.0001 * (origin_radius + s * widening) + 1e-6;
    const double missing = wide + off + here;
    if (missing < 0.0) return true;
    s += std::max(0.5 * spacing_, here > 0.0 ? here - off : missing - 2.0 * off);
  }
  return false;
}

}  // namespace sf::raycast
