#include "raycast/wall_lists.h"

#include <algorithm>
#include <cmath>

namespace sf::raycast {

namespace {

/// Rings in which distances double: segments of one are listed by bearing, so that blocks are narrow and can be hidden.
constexpr double kRings = 2.0;

/// @param radius [m] of the disc that holds all viewers
FoundWall found(Vec2 a, Vec2 b, std::uint32_t row, double radius) {
  FoundWall f{a, b, row, std::max(0.0, world::distance({}, a, b) - radius), 0.0, 2.0 * M_PI, -1};
  const double distance_a = length(a), distance_b = length(b);
  if (f.nearest <= 0.0 || distance_a <= radius || distance_b <= radius) return f;
  const double bearing_a = std::atan2(a.y, a.x), turn = std::atan2(cross(a, b), dot(a, b));
  const double wide_a = std::asin(radius / distance_a), wide_b = std::asin(radius / distance_b);
  const double low = std::min(-wide_a, turn - wide_b), high = std::max(wide_a, turn + wide_b);
  f.half = 0.5 * (high - low);
  f.bearing = std::remainder(bearing_a + 0.5 * (low + high), 2.0 * M_PI);
  f.ring = static_cast<int>(std::floor(std::log2((f.nearest + radius) / radius) * kRings));
  return f;
}

}  // namespace

bool clip(Vec2& a, Vec2& b, double reach) {
  const Vec2 e = b - a;
  const double ee = dot(e, e);
  const double middle = -dot(a, e) / ee;
  const Vec2 foot = a + middle * e;
  const double half_square = (reach * reach - dot(foot, foot)) / ee;
  if (half_square <= 0.0) return false;
  const double half = std::sqrt(half_square);
  const double u0 = std::max(0.0, middle - half);
  const double u1 = std::min(1.0, middle + half);
  if (u0 >= u1) return false;
  const Vec2 start = a;
  if (u1 < 1.0) b = start + u1 * e;
  if (u0 > 0.0) a = start + u0 * e;
  return true;
}

void find_walls(const Sight& sight, const CellShape& shape, Vec2 centre, bool both_sides, FoundWalls& walls) {
  const double radius = shape.radius();
  walls.facing.clear();
  walls.behind.clear();
  sight.near(centre, shape.reach(), walls.nearby);
  for (const std::uint32_t i : walls.nearby.found) {
    const SightSegment& s = sight.segments()[i];
    Vec2 a = s.a - centre, b = s.b - centre;
    if (!clip(a, b, shape.reach())) continue;
    // The cell's signed distance from the segment's line: positive on its left.
    const Vec2 e = s.b - s.a;
    const double side = cross(e, centre - s.a) / length(e);
    const bool both = both_sides || !s.solid_left;
    if (side < radius) walls.facing.push_back(found(a, b, s.row, radius));
    if (side > -radius && both) walls.facing.push_back(found(b, a, s.row, radius));
    if (side >= radius && !both) walls.behind.push_back(found(a, b, s.row, radius));
  }
}

}  // namespace sf::raycast
