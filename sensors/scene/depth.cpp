#include "sensors/scene/depth.h"

#include <algorithm>
#include <cmath>

namespace sf::sensors {

namespace {

constexpr double kCutOff = 1.0;  ///< [m]

}  // namespace

Depth::Depth(const Sight& sight, base::Workers& workers, std::size_t most_points) {
  if (sight.segments().empty()) return;
  low_ = sight.low();
  const Vec2 size = sight.high() - low_;
  spacing_ = std::max(0.05, std::sqrt(size.x * size.y / static_cast<double>(most_points)));
  per_spacing_ = 1.0 / spacing_;
  columns_ = static_cast<int>(std::min(size.x / spacing_, 1e6)) + 2;
  rows_ = static_cast<int>(std::min(size.y / spacing_, 1e6)) + 2;
  if (static_cast<double>(columns_) * rows_ > 4.0 * static_cast<double>(most_points)) columns_ = rows_ = 0;
  signed_.resize(static_cast<std::size_t>(columns_) * rows_);
  std::vector<Sight::Nearby> nearby(workers.threads());
  workers.run(static_cast<std::size_t>(rows_), 4, [&](std::size_t first, std::size_t last, unsigned thread) {
    for (std::size_t row = first; row < last; ++row)
      for (int column = 0; column < columns_; ++column) {
        const Vec2 p = low_ + Vec2{column * spacing_, static_cast<double>(row) * spacing_};
        double least = kCutOff;
        sight.near(p, kCutOff, nearby[thread]);
        for (const std::uint32_t i : nearby[thread].found)
          least = std::min(least, world::distance(p, sight.segments()[i].a, sight.segments()[i].b));
        const bool inside = least > 1e-6 && sight.inside_solid(p);
        signed_[row * columns_ + column] = static_cast<float>(inside ? -least : least);
      }
  });
}

bool Depth::is_on_grid(Vec2 q) const {
  return q.x >= low_.x && q.y >= low_.y && q.x <= low_.x + (columns_ - 1) * spacing_ &&
         q.y <= low_.y + (rows_ - 1) * spacing_;
}

float Depth::at(Vec2 q) const {
  const Vec2 nearest = per_spacing_ * (q - low_) + Vec2{0.5, 0.5};
  const int column = static_cast<int>(std::clamp(nearest.x, 0.0, columns_ - 1.0));
  const int row = static_cast<int>(std::clamp(nearest.y, 0.0, rows_ - 1.0));
  return signed_[static_cast<std::size_t>(row) * columns_ + column];
}

bool Depth::hides(Vec2 origin, double origin_radius, Vec2 p, double radius) const {
  if (signed_.empty()) return false;
  const double distance = length(p - origin);
  const double end = distance - radius;
  const Vec2 along = (1.0 / distance) * (p - origin);
  const double widening = (radius - origin_radius) / distance;
  const double off = 0.7072 * spacing_;
  for (double s = origin_radius; s < end;) {
    // Depth grows by at most a metre per metre: what is missing tells how far to go.
    const Vec2 q = origin + s * along;
    const double here = is_on_grid(q) ? at(q) : kCutOff;
    const double wide = 1.0001 * (origin_radius + s * widening) + 1e-6;
    const double missing = wide + off + here;
    if (missing < 0.0) return true;
    s += std::max(0.5 * spacing_, here > 0.0 ? here - off : missing - 2.0 * off);
  }
  return false;
}

}  // namespace sf::sensors
