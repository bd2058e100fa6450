#include "robots/footprint.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "base/error.h"
#include "world/wall_tree.h"

namespace sf::robots {

namespace {

using world::segments_meet;

bool overlap(const FootprintEdge& e, double z_min, double z_max) { return e.z_min < z_max && z_min < e.z_max; }

bool follows(const FootprintEdge& e, const FootprintEdge& before) {
  return e.a.x == before.b.x && e.a.y == before.b.y && e.z_min == before.z_min && e.z_max == before.z_max;
}

// Returns the inradius about the origin of one closed outline; 0 if the origin is outside.
double inradius(std::span<const FootprintEdge> loop) {
  if (!inside(loop, {0.0, 0.0}, loop.front().z_min, loop.front().z_max)) return 0.0;
  double nearest = HUGE_VAL;
  for (const FootprintEdge& e : loop) nearest = std::min(nearest, world::distance({0.0, 0.0}, e.a, e.b));
  return nearest;
}

// Returns the largest inradius among the chains of consecutive edges.
double largest_inradius(std::span<const FootprintEdge> edges) {
  double largest = 0.0;
  std::size_t first = 0;
  for (std::size_t i = 1; i <= edges.size(); ++i) {
    if (i < edges.size() && follows(edges[i], edges[i - 1])) continue;
    largest = std::max(largest, inradius(edges.subspan(first, i - first)));
    first = i;
  }
  return largest;
}

// For outlines whose edges do not meet. A chain of edges is then wholly inside or wholly outside, so its first corner
// decides.
bool any_inside(std::span<const FootprintEdge> chains, glm::dvec2 shift, const PlacedFootprint& outer) {
  for (std::size_t i = 0; i < chains.size(); ++i) {
    const FootprintEdge& e = chains[i];
    if (i > 0 && follows(e, chains[i - 1])) continue;
    const glm::dvec2 p = e.a + shift;
    if (dot(p, p) <= outer.radius * outer.radius && inside(outer.edges, p, e.z_min, e.z_max)) return true;
  }
  return false;
}

/// Returns whether one of a few directions separates all edges of q from those of p, so that they share no point. A
/// fast test that succeeds for most pairs that do not touch.
bool apart(const PlacedFootprint& p, const PlacedFootprint& q, glm::dvec2 d) {
  const auto beyond = [&](glm::dvec2 axis) {
    double p_most = -HUGE_VAL, q_least = HUGE_VAL;
    for (const FootprintEdge& e : p.edges) p_most = std::max({p_most, dot(axis, e.a), dot(axis, e.b)});
    for (const FootprintEdge& f : q.edges) q_least = std::min({q_least, dot(axis, f.a), dot(axis, f.b)});
    return dot(axis, d) + q_least - p_most > 1e-9 * (p.radius + q.radius) * (std::abs(axis.x) + std::abs(axis.y));
  };
  if (beyond(d)) return true;
  // Outward normals of the edges that face the other outline. Outward is on the right of a -> b.
  const auto normal = [](std::span<const FootprintEdge> edges, glm::dvec2 towards) {
    glm::dvec2 best{};
    double most = 0.0;
    for (const FootprintEdge& e : edges) {
      const glm::dvec2 n{e.b.y - e.a.y, e.a.x - e.b.x};
      if (!(dot(n, towards) > 0.0)) continue;
      const double facing = dot(n, towards) * dot(n, towards) / dot(n, n);
      if (facing > most) most = facing, best = n;
    }
    return best;
  };
  const glm::dvec2 from_p = normal(p.edges, d), from_q = normal(q.edges, glm::dvec2{} - d);
  return beyond(from_p) || beyond(glm::dvec2{} - from_q);
}

/// Returns the length of the chain of consecutive edges that begins at `first`.
std::size_t chain_length(std::span<const FootprintEdge> edges, std::size_t first) {
  std::size_t end = first + 1;
  while (end < edges.size() && follows(edges[end], edges[end - 1])) ++end;
  return end - first;
}

/// Returns whether every chain with a solid edge is a closed outline with the solid inside.
bool are_solids(std::span<const FootprintEdge> edges) {
  for (std::size_t first = 0; first < edges.size();) {
    const auto chain = edges.subspan(first, chain_length(edges, first));
    first += chain.size();
    const auto solid = [](const FootprintEdge& e) { return e.solid; };
    if (std::none_of(chain.begin(), chain.end(), solid)) continue;
    double area = 0.0;
    for (const FootprintEdge& e : chain) area += base::cross(e.a, e.b);
    if (!std::all_of(chain.begin(), chain.end(), solid) || !follows(chain.front(), chain.back()) || area <= 0.0)
      return false;
  }
  return true;
}

}  // namespace

bool surely_overlap(const Footprint& one, const Footprint& other, double apart, double lift) {
  if (one.inner == 0.0 || other.inner == 0.0 || apart >= 0.999 * (one.inner + other.inner)) return false;
  const FootprintEdge &p = one.edges.front(), &q = other.edges.front();
  return p.z_min < lift + q.z_max && lift + q.z_min < p.z_max;
}

bool inside(std::span<const FootprintEdge> edges, glm::dvec2 p, double z_min, double z_max) {
  int winding = 0;
  for (const FootprintEdge& e : edges) {
    if (!e.solid || !overlap(e, z_min, z_max)) continue;
    const double side = base::cross(e.b - e.a, p - e.a);
    if (e.a.y <= p.y && e.b.y > p.y && side > 0.0) ++winding;
    if (e.a.y > p.y && e.b.y <= p.y && side < 0.0) --winding;
  }
  return winding != 0;
}

Footprint footprint_of(const world::Mover& mover) {
  Footprint outline;
  outline.z_min = HUGE_VAL;
  outline.z_max = -HUGE_VAL;
  for (const world::Segment& s : mover.body) {
    if (!s.stops_robots) continue;
    outline.edges.push_back({s.a, s.b, s.z_min, s.z_max, s.solid_left});
    outline.radius = std::max({outline.radius, length(s.a), length(s.b)});
    outline.z_min = std::min(outline.z_min, s.z_min);
    outline.z_max = std::max(outline.z_max, s.z_max);
  }
  if (outline.edges.empty()) return {.step = 1.0};
  const double inner = largest_inradius(outline.edges);
  outline.step = inner > 0.0 ? inner / 4.0 : outline.radius / 16.0;
  if (outline.edges.front().solid && are_solids(outline.edges))
    outline.inner = inradius(std::span(outline.edges).first(chain_length(outline.edges, 0)));
  return outline;
}

PlacedFootprint place_footprint(const Footprint& outline, const base::Pose& X_WM, std::span<FootprintEdge> memory) {
  SF_CHECK(memory.size() >= outline.edges.size(), "room for " + std::to_string(memory.size()) + " edges");
  const auto [s, c] = base::sin_cos(X_WM.yaw);
  const auto turn = [c, s](glm::dvec2 p) { return glm::dvec2{c * p.x - s * p.y, s * p.x + c * p.y}; };
  for (std::size_t i = 0; i < outline.edges.size(); ++i) {
    const FootprintEdge& e = outline.edges[i];
    memory[i] = {turn(e.a), turn(e.b), e.z_min + X_WM.z, e.z_max + X_WM.z, e.solid};
  }
  return {{X_WM.x, X_WM.y}, outline.radius, memory.first(outline.edges.size())};
}

bool touches(const PlacedFootprint& placed, const world::Segment& wall) {
  const glm::dvec2 a = wall.a - placed.origin;
  const glm::dvec2 b = wall.b - placed.origin;
  if (world::distance({0.0, 0.0}, a, b) > placed.radius * (1.0 + 1e-12)) return false;
  for (const FootprintEdge& e : placed.edges) {
    if (overlap(e, wall.z_min, wall.z_max) && segments_meet(a, b, e.a, e.b)) return true;
  }
  return dot(a, a) <= placed.radius * placed.radius && inside(placed.edges, a, wall.z_min, wall.z_max);
}

bool touches(const PlacedFootprint& p, const PlacedFootprint& q) {
  const glm::dvec2 d = q.origin - p.origin;
  if (dot(d, d) > (p.radius + q.radius) * (p.radius + q.radius) * (1.0 + 1e-12) || apart(p, q, d)) return false;
  for (const FootprintEdge& e : p.edges) {
    if (world::distance(d, e.a, e.b) > q.radius * (1.0 + 1e-12)) continue;
    for (const FootprintEdge& f : q.edges) {
      if (overlap(e, f.z_min, f.z_max) && segments_meet(e.a, e.b, f.a + d, f.b + d)) return true;
    }
  }
  return any_inside(p.edges, glm::dvec2{} - d, q) || any_inside(q.edges, d, p);
}

}  // namespace sf::robots
