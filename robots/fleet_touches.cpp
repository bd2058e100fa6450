// Finds the bodies in contact with a mover, and the points of contact.

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "robots/fleet.h"

namespace sf::robots {

namespace {

using base::Pose;
using world::Segment;

double cross_of(glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; }

/// A point of a surface, and its distance from an outline.
struct NearestPoint {
  double distance = HUGE_VAL;
  glm::dvec2 p;
};

/// Updates `nearest` with the point of the segment cd that is nearest to ab: their intersection, or else an end of one
/// of them.
void update_nearest(NearestPoint& nearest, glm::dvec2 a, glm::dvec2 b, glm::dvec2 c, glm::dvec2 d) {
  const auto take = [&](glm::dvec2 p) {
    const double distance = world::distance(p, a, b);
    if (distance < nearest.distance) nearest = {distance, p};
  };
  const double turn = cross_of(b - a, d - c);
  if (turn != 0.0 && world::segments_meet(a, b, c, d))
    take(c + std::clamp(cross_of(b - a, a - c) / turn, 0.0, 1.0) * (d - c));
  take(c), take(d);
  take(a - world::from_segment(a, c, d)), take(b - world::from_segment(b, c, d));
}

/// A wall, or an edge of another mover, in the world frame.
struct TouchedSurface {
  glm::dvec2 a, b;
  double z_min, z_max;
};

NearestPoint point_nearest_to(const Footprint& outline, const Pose& X_WM, const TouchedSurface& surface) {
  NearestPoint nearest;
  for (const FootprintEdge& edge : outline.edges)
    if (edge.z_min + X_WM.z < surface.z_max && surface.z_min < edge.z_max + X_WM.z)
      update_nearest(nearest, transform(X_WM, edge.a), transform(X_WM, edge.b), surface.a, surface.b);
  return nearest;
}

}  // namespace

void Fleet::find_touches(std::uint32_t row, std::span<const base::Report> states, std::span<const std::uint32_t> others,
                         std::vector<Touch>& touches) const {
  const Footprint& outline = footprints_[row];
  const Pose& X_WM = states[row].X_WM;
  if (outline.edges.empty()) return;
  std::vector<std::pair<std::uint32_t, NearestPoint>> walls;  // by model
  walls_.any(world::box_around({X_WM.x, X_WM.y}, outline.radius + kContactDistance), [&](const Segment& wall) {
    if (contact_sectors(outline, X_WM, wall) != 0)
      walls.emplace_back(wall.model, point_nearest_to(outline, X_WM, {wall.a, wall.b, wall.z_min, wall.z_max}));
    return false;
  });
  std::sort(walls.begin(), walls.end(), [](const auto& one, const auto& other) {
    return std::tuple(one.first, one.second.distance, one.second.p.x, one.second.p.y) <
           std::tuple(other.first, other.second.distance, other.second.p.x, other.second.p.y);
  });
  for (const auto& [model, nearest] : walls)
    if (touches.empty() || touches.back().mover != world::kNone || touches.back().model != model)
      touches.push_back({model, world::kNone, nearest.p});
  for (const std::uint32_t other : others) {
    const Footprint& its = footprints_[other];
    const Pose& X_WO = states[other].X_WM;
    if (other == row || absent_[other] != 0 || contact_sectors(outline, X_WM, its, X_WO) == 0) continue;
    NearestPoint nearest{HUGE_VAL, {X_WO.x, X_WO.y}};
    for (const FootprintEdge& edge : its.edges) {
      const NearestPoint here = point_nearest_to(
          outline, X_WM, {transform(X_WO, edge.a), transform(X_WO, edge.b), edge.z_min + X_WO.z, edge.z_max + X_WO.z});
      if (here.distance < nearest.distance) nearest = here;
    }
    touches.push_back({world_.movers[other].model, other, nearest.p});
  }
}

}  // namespace sf::robots
