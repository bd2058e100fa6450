#include "sensors/scene/clearance.h"

#include <algorithm>
#include <cmath>

#include "sensors/scene/sight.h"

namespace sf::sensors {

namespace {

bool same(Vec2 p, Vec2 q) { return p.x == q.x && p.y == q.y; }

/// Ends p and q on both sides of line ab, or one on it; segments of one line are left to the distances of their ends.
bool straddles(Vec2 a, Vec2 b, Vec2 p, Vec2 q) {
  const double sp = cross(b - a, p - a);
  const double sq = cross(b - a, q - a);
  return (sp != 0.0 || sq != 0.0) && ((sp <= 0.0 && sq >= 0.0) || (sp >= 0.0 && sq <= 0.0));
}

double separation(const world::Segment& s, const world::Segment& t) {
  if (straddles(s.a, s.b, t.a, t.b) && straddles(t.a, t.b, s.a, s.b)) return 0.0;
  return std::min({distance_to_segment(s.a, t.a, t.b), distance_to_segment(s.b, t.a, t.b),
                   distance_to_segment(t.a, s.a, s.b), distance_to_segment(t.b, s.a, s.b)});
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

}  // namespace

std::vector<float> wall_clearances(const std::vector<world::Segment>& walls, double cap) {
  // All heights together: what is far from everything is far from what a beam can see.
  world::World flat;
  flat.walls = walls;
  double total = 0.0;
  for (world::Segment& s : flat.walls) {
    s.z_min = 0.0;
    s.z_max = 1.0;
    total += length(s.b - s.a);
  }
  const double typical = walls.empty() ? 1.0 : total / static_cast<double>(walls.size());
  const Sight all(flat, 0.5, 4.0 * std::max(typical, cap));
  std::vector<float> clearances(walls.size(), 0.0f);
  Sight::Nearby nearby;
  for (const SightSegment& sight : all.segments()) {
    const world::Segment& s = walls[sight.row];
    const Vec2 middle = 0.5 * (s.a + s.b);
    double least = cap;
    all.near(middle, 0.5 * length(s.b - s.a) + cap, nearby);
    for (const std::uint32_t i : nearby.found) {
      const std::uint32_t row = all.segments()[i].row;
      if (row == sight.row || fair_neighbour(s, walls[row])) continue;
      least = std::min(least, separation(s, walls[row]));
      if (least == 0.0) break;
    }
    clearances[sight.row] = static_cast<float>(0.99 * least);
  }
  return clearances;
}

}  // namespace sf::sensors
