#include "raycast/clearance.h"

#include <algorithm>
#include <cmath>

#include "raycast/sight.h"

namespace sf::raycast {

namespace {

bool same(Vec2 p, Vec2 q) { return p.x == q.x && p.y == q.y; }

double separation(const world::Segment& s, const world::Segment& t) {
  if (world::segments_meet(s.a, s.b, t.a, t.b)) return 0.0;
  return std::min({world::distance(s.a, t.a, t.b), world::distance(s.b, t.a, t.b), world::distance(t.a, s.a, s.b),
                   world::distance(t.b, s.a, s.b)});
}

/// True when `t` starts at an end of `s` and leaves it at a fair angle: then their distance grows with that from the
/// end.
bool fair_neighbour(const world::Segment& s, const world::Segment& t) {
  constexpr double kCosine15 = 0.9659258262890683;
  for (const auto& [shared, other] : {std::pair{s.a, s.b}, std::pair{s.b, s.a}}) {
    if (!same(shared, t.a) && !same(shared, t.b)) continue;
    const Vec2 along_s = other - shared;
    const Vec2 along_t = (same(shared, t.a) ? t.b : t.a) - shared;
    return dot(along_s, along_t) < kCosine15 * length(along_s) * length(along_t);
  }
  return false;
}

/// [m] where the search for neighbours begins: `cap` or a wall's usual length; where walls are dense, what holds a few.
double first_radius(const std::vector<world::Segment>& walls, double cap) {
  if (walls.empty()) return cap;
  double total = 0.0;
  Vec2 low = walls[0].a, high = walls[0].a;
  for (const world::Segment& s : walls) {
    total += length(s.b - s.a);
    low = {std::min({low.x, s.a.x, s.b.x}), std::min({low.y, s.a.y, s.b.y})};
    high = {std::max({high.x, s.a.x, s.b.x}), std::max({high.y, s.a.y, s.b.y})};
  }
  const auto count = static_cast<double>(walls.size());
  const double dense = std::sqrt(4.0 * (high.x - low.x) * (high.y - low.y) / count);
  return std::max(total / count, std::min(cap, dense));
}

}  // namespace

std::vector<float> wall_clearances(const std::vector<world::Segment>& walls, double cap) {
  const double first = first_radius(walls, cap);
  const Sight all = Sight::of_all_heights(walls, 4.0 * first);
  std::vector<float> clearances(walls.size(), 0.0f);
  Sight::Nearby nearby;
  for (const SightSegment& sight : all.segments()) {
    const world::Segment& s = walls[sight.row];
    const Vec2 middle = 0.5 * (s.a + s.b);
    // Where walls are dense the nearest is found among few: what lies within the radius has all been seen.
    double least = cap;
    for (double radius = std::min(first, cap);; radius = std::min(4.0 * radius, cap)) {
      all.near(middle, 0.5 * length(s.b - s.a) + radius, nearby);
      for (const std::uint32_t i : nearby.found) {
        const std::uint32_t row = all.segments()[i].row;
        if (row == sight.row || fair_neighbour(s, walls[row])) continue;
        least = std::min(least, separation(s, walls[row]));
        if (least == 0.0) break;
      }
      if (least <= radius) break;
    }
    clearances[sight.row] = static_cast<float>(0.99 * least);
  }
  return clearances;
}

}  // namespace sf::raycast
