#include "world/overlaps.h"

#include <set>

#include "world/wall_tree.h"

namespace sf::world {

namespace {

constexpr std::uint64_t kMaxComparisons = 20'000'000;  // of edges
constexpr double kShrink = 0.98;                       // scale of outlines, so that contact does not count

struct Body {
  const Mover* mover;
  std::vector<Segment> edges;  ///< edges that stop robots, in the world frame, slightly shrunk
};

Body body_of(const Mover& mover) {
  Body body{&mover, {}};
  for (const Segment& side : mover.body) {
    if (!side.stops_robots || mover.is_tag) continue;
    body.edges.push_back(side);
    body.edges.back().a = transform(mover.X_WM, kShrink * side.a);
    body.edges.back().b = transform(mover.X_WM, kShrink * side.b);
    body.edges.back().z_min += mover.X_WM.z;
    body.edges.back().z_max += mover.X_WM.z;
  }
  return body;
}

bool same_height(const Segment& a, const Segment& b) { return a.z_min < b.z_max && b.z_min < a.z_max; }

bool contains(const Body& outer, const Body& inner) {
  const glm::dvec2 p{inner.mover->X_WM.x, inner.mover->X_WM.y};
  int sum = 0;
  for (const Segment& edge : outer.edges)
    if (same_height(edge, inner.edges.front())) sum += winding_number(std::span(&edge, 1), p);
  return sum != 0;
}

bool overlap(const Body& a, const Body& b, std::uint64_t& comparisons) {
  comparisons += a.edges.size() * b.edges.size();
  for (const Segment& s : a.edges)
    for (const Segment& t : b.edges)
      if (same_height(s, t) && segments_meet(s.a, s.b, t.a, t.b)) return true;
  return contains(a, b) || contains(b, a);
}

}  // namespace

Overlaps find_overlaps(const World& world) {
  std::vector<Body> bodies;
  std::vector<Box> boxes;
  std::vector<std::uint32_t> rows;
  for (std::uint32_t row = 0; row < world.movers.size(); ++row) {
    Body body = body_of(world.movers[row]);
    if (body.edges.empty()) continue;
    boxes.push_back(box_of(body.edges));
    bodies.push_back(std::move(body));
    rows.push_back(row);
  }

  // Each robot looks for only one partner, so a crowd at one place costs no more than separate robots.
  const base::BoxTree tree(boxes);
  Overlaps found;
  std::set<Overlap> pairs;
  std::uint64_t comparisons = 0;
  for (std::uint32_t i = 0; i < bodies.size() && comparisons < kMaxComparisons; ++i) {
    const bool any = tree.any(boxes[i], [&](std::uint32_t k) {
      if (k == i || comparisons >= kMaxComparisons || !overlap(bodies[i], bodies[k], comparisons)) return false;
      pairs.insert({std::min(rows[i], rows[k]), std::max(rows[i], rows[k])});
      return true;
    });
    if (any) found.robots.push_back(rows[i]);
  }
  found.pairs.assign(pairs.begin(), pairs.end());
  found.complete = comparisons < kMaxComparisons;
  return found;
}

}  // namespace sf::world
