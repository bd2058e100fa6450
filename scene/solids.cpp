#include "scene/solids.h"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <map>
#include <optional>
#include <tuple>
#include <vector>

#include "base/box_tree.h"
#include "base/pose.h"
#include "scene/join_triangles.h"
#include "scene/rectangles.h"
#include "scene/trapezoids.h"
#include "world/ground.h"
#include "world/terrain.h"

namespace sf::scene {

namespace {

using world::Segment;

/// One closed outline.
struct Loop {
  std::span<const Segment> segments;
  double area = 0.0;  ///< [m^2] positive: around a solid; negative: around a hole in one
  glm::dvec2 low{HUGE_VAL}, high{-HUGE_VAL};

  bool contains(glm::dvec2 p) const {
    if (!(p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y)) return false;
    bool inside = false;
    for (const Segment& s : segments)
      if ((s.a.y > p.y) != (s.b.y > p.y) && p.x < s.a.x + (s.b.x - s.a.x) * ((p.y - s.a.y) / (s.b.y - s.a.y)))
        inside = !inside;
    return inside;
  }
};

bool one_height(const Segment& s, const Segment& t) { return s.z_min == t.z_min && s.z_max == t.z_max; }
bool one_outline(const Segment& s, const Segment& t) {
  return s.model == t.model && one_height(s, t) && s.solid_left == t.solid_left;
}

Loop loop_of(std::span<const Segment> segments) {
  Loop loop{segments};
  const glm::dvec2 origin = segments.front().a;
  for (const Segment& s : segments) {
    loop.area += 0.5 * base::cross(s.a - origin, s.b - origin);
    loop.low = glm::min(loop.low, s.a), loop.high = glm::max(loop.high, s.a);
  }
  return loop;
}

/// Returns the end of the outline that begins at `first`. Holes may be listed backward, each segment ending where the
/// previous one starts. @param closed out: the outline ends where it begins
std::size_t end_of_outline(std::span<const Segment> segments, std::size_t first, bool& closed) {
  std::size_t end = first + 1;
  const Segment& one = segments[first];
  if (end == segments.size() || !one_outline(one, segments[end])) return end;
  const bool forward = segments[end].a == one.b;
  const auto start_of = [&](const Segment& s) { return forward ? s.a : s.b; };
  const auto end_of = [&](const Segment& s) { return forward ? s.b : s.a; };
  const glm::dvec2 start = start_of(one);
  while (end < segments.size() && end_of(segments[end - 1]) != start &&
         start_of(segments[end]) == end_of(segments[end - 1]) && one_outline(one, segments[end]))
    ++end;
  closed = end_of(segments[end - 1]) == start;
  return end;
}

/// Returns the closed outlines of solids.
/// @param rest out: all other segments of solids
std::vector<Loop> loops_of(std::span<const Segment> segments, std::vector<Segment>& rest) {
  std::vector<Loop> loops;
  for (std::size_t first = 0; first < segments.size();) {
    bool closed = false;
    const std::size_t end = end_of_outline(segments, first, closed);
    const auto outline = segments.subspan(first, end - first);
    if (segments[first].solid_left && closed) loops.push_back(loop_of(outline));
    if (segments[first].solid_left && !closed) rest.insert(rest.end(), outline.begin(), outline.end());
    first = end;
  }
  return loops;
}

/// Outlines of holes, by place.
class Holes {
 public:
  explicit Holes(std::span<const Loop> loops) {
    std::vector<base::Box> boxes;
    for (const Loop& loop : loops)
      if (loop.area < 0.0) holes_.push_back(&loop), boxes.push_back({loop.low, loop.high});
    tree_ = base::BoxTree(boxes);
  }
  /// Calls `take` with each hole in a solid. Clockwise outlines of any model are holes.
  template <class Take>
  void for_each_in(const Loop& outer, const Take& take) const {
    tree_.any({outer.low, outer.high}, [&](std::uint32_t i) {
      const Segment& edge = holes_[i]->segments.front();
      if (one_height(edge, outer.segments.front()) && outer.contains(edge.a)) take(*holes_[i]);
      return false;
    });
  }

 private:
  std::vector<const Loop*> holes_;
  base::BoxTree tree_;
};

/// Appends the pieces of a region at each height.
void add_flat(std::span<const Trapezoid> pieces, std::span<const double> heights, Mesh& mesh,
              std::optional<std::uint32_t> owner) {
  for (const Trapezoid& piece : pieces) {
    std::vector<glm::dvec2> corners(piece.begin(), piece.end());
    const auto same = std::unique(corners.begin(), corners.end());
    corners.erase(same, corners.end());
    if (corners.back() == corners.front()) corners.pop_back();
    if (corners.size() < 3) continue;
    for (const double z : heights) {
      std::vector<glm::dvec3> flat;
      for (const glm::dvec2& c : corners) flat.emplace_back(c, z);
      mesh.add(flat, owner);
    }
  }
}

std::vector<double> cap_heights(const Segment& solid, bool on_floor) {
  std::vector<double> heights{solid.z_min, solid.z_max};
  if (on_floor) std::erase(heights, 0.0);
  return heights;
}

/// Appends the top and bottom of the solid inside an outline, without its holes.
void add_caps(const Loop& outer, const Holes& holes, bool on_floor, Mesh& mesh) {
  const Segment& solid = outer.segments.front();
  std::vector<RegionEdge> edges;
  const auto add = [&](const Loop& loop) {
    for (const Segment& s : loop.segments) edges.push_back({s.a, s.b});
  };
  add(outer);
  holes.for_each_in(outer, add);
  add_flat(trapezoids_of(edges), cap_heights(solid, on_floor), mesh, solid.model);
}

/// Returns whether the edges are closed outlines: as many begin as end at each point.
bool are_closed(std::span<const RegionEdge> edges) {
  std::vector<std::array<double, 2>> starts, ends;
  for (const RegionEdge& e : edges) starts.push_back({e.a.x, e.a.y}), ends.push_back({e.b.x, e.b.y});
  std::ranges::sort(starts), std::ranges::sort(ends);
  return starts == ends;
}

/// Appends the tops and bottoms of solids whose outlines are in any order, as those of pictures. An open outline has no
/// inside.
void add_unordered_caps(std::span<const Segment> segments, bool on_floor, Mesh& mesh) {
  std::map<std::tuple<std::uint32_t, double, double>, std::vector<const Segment*>> solids;
  for (const Segment& s : segments) solids[{s.model, s.z_min, s.z_max}].push_back(&s);
  for (const auto& [key, sides] : solids) {
    std::vector<RegionEdge> edges;
    for (const Segment* s : sides) edges.push_back({s->a, s->b});
    if (!are_closed(edges)) continue;
    const auto rectangles = rectangles_of(edges);
    add_flat(rectangles ? *rectangles : trapezoids_of(edges), cap_heights(*sides[0], on_floor), mesh, sides[0]->model);
  }
}

/// Appends the outline of a hole clockwise.
void add_hole(std::span<const glm::dvec2> outline, std::vector<RegionEdge>& edges) {
  double area = 0.0;
  for (std::size_t i = 0; i + 1 < outline.size(); ++i)
    area += base::cross(outline[i] - outline[0], outline[i + 1] - outline[0]);
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const glm::dvec2 a = outline[i], b = outline[(i + 1) % outline.size()];
    if (a != b) edges.push_back(area > 0.0 ? RegionEdge{b, a} : RegionEdge{a, b});
  }
}

}  // namespace

Mesh mesh_of(std::span<const Segment> segments, bool on_floor) {
  std::vector<Segment> seen;
  for (const Segment& s : segments)
    if (s.seen_by_laser && s.z_min < s.z_max) seen.push_back(s);
  Mesh mesh;
  for (const Segment& s : seen) {
    const std::array<glm::dvec3, 4> side{glm::dvec3{s.a, s.z_min}, {s.b, s.z_min}, {s.b, s.z_max}, {s.a, s.z_max}};
    mesh.add(side, s.model);
  }
  std::vector<Segment> rest;
  const std::vector<Loop> loops = loops_of(seen, rest);
  const Holes holes(loops);
  for (const Loop& loop : loops)
    if (loop.area > 0.0) add_caps(loop, holes, on_floor, mesh);
  add_unordered_caps(rest, on_floor, mesh);
  return mesh;
}

Mesh roads_of(const world::World& world) {
  Mesh mesh;
  for (const world::Ramp& ramp : world.ramps) {
    const glm::dvec2 along = ramp.b - ramp.a;
    const double length = glm::length(along);
    if (!(length > 0.0) || (ramp.z_a == 0.0 && ramp.z_b == 0.0)) continue;
    const glm::dvec2 left = ramp.half_width / length * glm::dvec2{-along.y, along.x};
    const glm::dvec2 past = world::Ground::kOverlap * ramp.half_width / length * along;
    const auto add = [&](glm::dvec2 a, double z_a, glm::dvec2 b, double z_b) {
      mesh.add(std::array<glm::dvec3, 4>{glm::dvec3{a - left, z_a}, {b - left, z_b}, {b + left, z_b}, {a + left, z_a}},
               {});
    };
    add(ramp.a - past, ramp.z_a, ramp.a, ramp.z_a);
    add(ramp.a, ramp.z_a, ramp.b, ramp.z_b);
    add(ramp.b, ramp.z_b, ramp.b + past, ramp.z_b);
  }
  return mesh;
}

base::Box box_of_holes(const world::World& world) {
  base::Box box = base::empty_box();
  for (const world::FloorHole& hole : world.floor_holes)
    for (const glm::dvec2& p : hole.outline) box = {glm::min(box.min, p), glm::max(box.max, p)};
  for (const world::Terrain& terrain : world.terrain)
    for (const glm::dvec2& p : world::outline_of(terrain)) box = {glm::min(box.min, p), glm::max(box.max, p)};
  return box;
}

Mesh holed_floor(const world::World& world, double reach) {
  Mesh mesh;
  std::vector<RegionEdge> edges;
  for (const world::FloorHole& hole : world.floor_holes) add_hole(hole.outline, edges);
  for (const world::Terrain& terrain : world.terrain) add_hole(world::outline_of(terrain), edges);
  const base::Box box = box_of_holes(world);
  const glm::dvec2 low = box.min - 2.0 * reach, high = box.max + 2.0 * reach;
  const std::array<glm::dvec2, 4> outer{low, {high.x, low.y}, high, {low.x, high.y}};
  for (std::size_t i = 0; i < 4; ++i) edges.push_back({outer[i], outer[(i + 1) % 4]});
  add_flat(trapezoids_of(split_at_crossings(edges)), std::array{0.0}, mesh, {});
  return mesh;
}

Mesh mesh_of(const world::Mesh& triangles, std::vector<std::uint32_t> materials,
             std::span<const glm::vec2> coordinates) {
  Mesh mesh{triangles.vertices, {}, {}, {}, {}};
  const std::vector<std::uint32_t>& corners = triangles.corners;
  mesh.faces.reserve(corners.size() / 3);
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
    const glm::dvec3 p = mesh.vertices[corners[i]];
    const glm::dvec3 normal = glm::cross(mesh.vertices[corners[i + 1]] - p, mesh.vertices[corners[i + 2]] - p);
    if (!(glm::dot(normal, normal) > 0.0)) continue;
    mesh.faces.push_back({corners[i], corners[i + 1], corners[i + 2], corners[i + 2]});
    if (!materials.empty()) mesh.materials.push_back(materials[i / 3]);
    if (!coordinates.empty()) mesh.coordinates.push_back({coordinates[i], coordinates[i + 1], coordinates[i + 2]});
  }
  return join_triangles(std::move(mesh));
}

}  // namespace sf::scene
