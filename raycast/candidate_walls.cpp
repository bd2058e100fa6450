#include "raycast/candidate_walls.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "world/wall_tree.h"

namespace sf::raycast {

namespace {

/// [rad] error bound of the bearings computed here.
constexpr double kSlack = 1e-5;

/// Returns an upper bound [rad] of the arc sine of v in [0, 1), except for rounding.
double asin_bound(double v) {
  if (v > 0.8) return base::asin(v);
  const double vv = v * v;
  return v * (1.0 + vv * (1.0 / 6.0 + vv * (0.075 + vv * 0.2)));
}

}  // namespace

/// Arc tangent by Abramowitz and Stegun 4.4.49.
double fast_bearing(glm::dvec2 p) {
  const double along = std::abs(p.x), across = std::abs(p.y);
  const double q = std::min(along, across) / std::max(along, across), z = q * q;
  double t = 0.0028662257;
  for (const double c :
       {-0.0161657367, 0.0429096138, -0.0752896400, 0.1065626393, -0.1420889944, 0.1999355085, -0.3333314528, 1.0})
    t = t * z + c;
  t *= q;
  if (across > along) t = 0.5 * M_PI - t;
  if (p.x < 0.0) t = M_PI - t;
  return std::copysign(t, p.y);
}

CandidateWall candidate_wall(glm::dvec2 a, glm::dvec2 b, std::uint32_t row, double radius) {
  CandidateWall f{a, b, row, std::max(0.0, world::distance({}, a, b) - radius), 0.0, 2.0 * M_PI, -1};
  const double share_a = radius / length(a), share_b = radius / length(b);
  if (f.nearest <= 0.0 || std::max(share_a, share_b) >= 1.0) return f;
  const double bearing_a = fast_bearing(a), turn = base::wrap_angle(fast_bearing(b) - bearing_a);
  const double wide_a = asin_bound(share_a) + kSlack, wide_b = asin_bound(share_b) + kSlack;
  const double low = std::min(-wide_a, turn - wide_b), high = std::max(wide_a, turn + wide_b);
  f.distance_ring = std::ilogb((f.nearest + radius) / radius);
  if (std::abs(turn) > M_PI - kSlack) return f;
  f.half = 0.5 * (high - low);
  f.bearing = base::wrap_angle(bearing_a + 0.5 * (low + high));
  return f;
}

bool clip(glm::dvec2& a, glm::dvec2& b, double reach) {
  const glm::dvec2 e = b - a;
  const double ee = dot(e, e);
  const double middle = -dot(a, e) / ee;
  const glm::dvec2 foot = a + middle * e;
  const double half_square = (reach * reach - dot(foot, foot)) / ee;
  if (half_square <= 0.0) return false;
  const double half = std::sqrt(half_square);
  const double u0 = std::max(0.0, middle - half);
  const double u1 = std::min(1.0, middle + half);
  if (u0 >= u1) return false;
  const glm::dvec2 start = a;
  if (u1 < 1.0) b = start + u1 * e;
  if (u0 > 0.0) a = start + u0 * e;
  return true;
}

void find_candidate_walls(const WallIndex& wall_index, const CellShape& shape, glm::dvec2 centre, double z,
                          bool both_sides, CandidateWalls& walls) {
  const double radius = shape.radius();
  walls.front_facing.clear();
  walls.back_facing.clear();
  wall_index.near(centre, z, shape.reach(), walls.near);
  for (const std::uint32_t i : walls.near) {
    const IndexedWall& s = wall_index.segments()[i];
    glm::dvec2 a = s.a - centre, b = s.b - centre;
    if (!clip(a, b, shape.reach())) continue;
    // Signed distance of the cell from the segment's line: positive on its left.
    const glm::dvec2 e = s.b - s.a;
    const double side = base::cross(e, centre - s.a) / length(e);
    const bool both = both_sides || !s.solid_left;
    if (side < radius) walls.front_facing.push_back(candidate_wall(a, b, s.row, radius));
    if (side > -radius && both) walls.front_facing.push_back(candidate_wall(b, a, s.row, radius));
    if (side >= radius && !both) walls.back_facing.push_back(candidate_wall(a, b, s.row, radius));
  }
}

}  // namespace sf::raycast
