#include "world/outline_walls.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "world/stage/properties.h"
#include "world/wall_tree.h"

namespace sf::world {

namespace {

constexpr double kTouching = 1e-6;  // [m] tolerance for a corner of an inner ring that may be on its outer ring
constexpr double kMaxWalls = 5e7;   // per file

[[noreturn]] void refuse_pairs(std::size_t corners) {
  throw base::InputError(
      fmt::format("a ring of {} corners: its check for crossings exceeds the file's limit of 1e+09 pairs of edges; "
                  "simplify it (ST_Simplify, ogr2ogr -simplify)",
                  corners));
}

double distance_to(const Segment& wall, glm::dvec2 p) {
  const glm::dvec2 along = wall.b - wall.a;
  return length(p - wall.a - std::clamp(dot(p - wall.a, along) / dot(along, along), 0.0, 1.0) * along);
}

}  // namespace

bool OutlineWalls::build(const WellKnownGeometry& geometry, double height) {
  walls_.clear();
  ends_.clear();
  outer_.solid = false;
  holes_outside_ = 0;
  std::size_t begin = 0;
  for (const WellKnownGeometry::Part& part : geometry.parts) {
    const auto points = std::span(geometry.points).subspan(begin, part.end - begin);
    begin = part.end;
    if (part.kind == WellKnownGeometry::Kind::line) {
      for (std::size_t k = 1; k < points.size(); ++k) add_wall(points[k - 1], points[k], false);
    } else if (part.kind == WellKnownGeometry::Kind::outer) {
      add_outer_ring(points);
    } else {
      add_hole(points);
    }
    if (walls_.size() > (ends_.empty() ? 0 : ends_.back())) ends_.push_back(walls_.size());
  }
  for (Segment& wall : walls_) {
    wall.z_min = file_.X_WF.z;
    wall.z_max = file_.X_WF.z + height;
  }
  return !walls_.empty();
}

void OutlineWalls::finish() {
  count_ += static_cast<double>(walls_.size());
  if (count_ > kMaxWalls)
    throw base::InputError(file_.file, 0, fmt::format("has more than {:g} walls, the limit for a file", kMaxWalls));
  std::size_t begin = 0;
  for (const std::size_t end : ends_) {
    take_(std::span(walls_).subspan(begin, end - begin));
    begin = end;
  }
}

Polygon OutlineWalls::polygon_of(std::span<const glm::dvec2> points) {
  auto polygon = make_polygon({points.begin(), points.end()}, pairs_);
  if (!polygon) refuse_pairs(points.size());
  return *std::move(polygon);
}

void OutlineWalls::add_outer_ring(std::span<const glm::dvec2> points) {
  const Polygon ring = polygon_of(points);
  outer_.begin = walls_.size();
  outer_.solid = ring.solid_left;
  for (const PolygonEdge& edge : ring.edges) add_wall(edge.a, edge.b, ring.solid_left);
  outer_.end = walls_.size();
}

/// Without a surrounding solid, a hole would swap inside and outside.
void OutlineWalls::add_hole(std::span<const glm::dvec2> points) {
  const Polygon ring = polygon_of(points);
  const bool outside = outer_.solid && is_outside(ring);
  holes_outside_ += outside;
  const bool solid = ring.solid_left && outer_.solid && !outside;
  for (auto edge = ring.edges.rbegin(); edge != ring.edges.rend(); ++edge) add_wall(edge->b, edge->a, solid);
}

bool OutlineWalls::is_outside(const Polygon& hole) {
  const double pairs = static_cast<double>(hole.edges.size()) * static_cast<double>(outer_.end - outer_.begin);
  if (pairs > pairs_) refuse_pairs(hole.edges.size());
  pairs_ -= pairs;
  const auto outer = std::span(walls_).subspan(outer_.begin, outer_.end - outer_.begin);
  return std::any_of(hole.edges.begin(), hole.edges.end(), [&](const PolygonEdge& edge) {
    const glm::dvec2 p = placed(edge.a);
    const auto touches = [&](const Segment& wall) { return distance_to(wall, p) <= kTouching; };
    return winding_number(outer, p) == 0 && std::none_of(outer.begin(), outer.end(), touches);
  });
}

glm::dvec2 OutlineWalls::placed(glm::dvec2 p) const { return transform(file_.X_WF, file_.metres_per_unit * p); }

void OutlineWalls::add_wall(glm::dvec2 a, glm::dvec2 b, bool solid) {
  Segment wall = file_.surface;
  wall.a = placed(a);
  wall.b = placed(b);
  wall.solid_left = solid;
  const double farthest = std::max({std::abs(wall.a.x), std::abs(wall.a.y), std::abs(wall.b.x), std::abs(wall.b.y)});
  if (!(farthest <= kMaxLength))
    throw base::InputError(
        fmt::format("a corner is {:g} m from the origin of the world; expected at most {:g} m: shift "
                    "the outlines by the model's 'pose'",
                    farthest, kMaxLength));
  if (wall.a != wall.b) walls_.push_back(wall);
}

}  // namespace sf::world
