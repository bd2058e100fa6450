// robots/footprint.h in kernels: outlines at poses, and their contacts.

#include "shaders/lib/planar64.glsl"

struct Edge {
  dvec2 a, b;
  double z_min, z_max;
  bool solid;
};

/// An outline, turned and lifted. Its edges are computed where they are needed, relative to `origin`.
struct Placed {
  dvec2 origin;
  double radius, sine, cosine, z;
  int first, count;
};

Placed place_footprint(FleetFootprint outline, FleetPose X_WM) {
  return Placed(origin_of(X_WM), outline.radius, X_WM.sine, X_WM.cosine, X_WM.z, int(outline.first), int(outline.count));
}

/// Returns the outline in the mover's frame.
Placed unplaced(FleetFootprint outline) {
  return Placed(dvec2(0.0LF), outline.radius, 0.0LF, 1.0LF, 0.0LF, int(outline.first), int(outline.count));
}

Edge edge_of(Placed p, int i) {
  const FleetEdge e = load_FleetEdge(edges, p.first + i);
  precise double z_min = e.z_min + p.z;
  precise double z_max = e.z_max + p.z;
  return Edge(turned(dvec2(e.ax, e.ay), p.sine, p.cosine), turned(dvec2(e.bx, e.by), p.sine, p.cosine), z_min, z_max,
              e.solid != 0u);
}

bool overlap(Edge e, double z_min, double z_max) { return e.z_min < z_max && z_min < e.z_max; }

bool follows(Edge e, Edge before) {
  return e.a.x == before.b.x && e.a.y == before.b.y && e.z_min == before.z_min && e.z_max == before.z_max;
}

bool is_inside(Placed outline, dvec2 p, double z_min, double z_max) {
  int winding = 0;
  for (int i = 0; may_turn(1u) && i < outline.count; ++i) {
    const Edge e = edge_of(outline, i);
    const bool counts = e.solid && overlap(e, z_min, z_max);
    const double side = cross64(minus(e.b, e.a), minus(p, e.a));
    winding += counts && e.a.y <= p.y && e.b.y > p.y && side > 0.0LF ? 1 : 0;
    winding -= counts && e.a.y > p.y && e.b.y <= p.y && side < 0.0LF ? 1 : 0;
  }
  return winding != 0;
}

bool touches_wall(Placed placed, FleetWall wall) {
  const dvec2 a = minus(dvec2(wall.ax, wall.ay), placed.origin), b = minus(dvec2(wall.bx, wall.by), placed.origin);
  precise double reach = placed.radius * (1.0LF + 1e-12LF);
  if (distance64(dvec2(0.0LF), a, b) > reach) return false;
  bool met = false;
  for (int i = 0; may_turn(1u) && i < placed.count && !met; ++i) {
    const Edge e = edge_of(placed, i);
    met = overlap(e, wall.z_min, wall.z_max) && segments_meet(a, b, e.a, e.b);
  }
  precise double square = placed.radius * placed.radius;
  return met || (dot64(a, a) <= square && is_inside(placed, a, wall.z_min, wall.z_max));
}

/// Returns the outward normal of the edge that faces `towards` most.
dvec2 facing_normal(Placed placed, dvec2 towards) {
  dvec2 best = dvec2(0.0LF);
  double farthest = 0.0LF;
  for (int i = 0; may_turn(1u) && i < placed.count; ++i) {
    const Edge e = edge_of(placed, i);
    precise dvec2 n = dvec2(e.b.y - e.a.y, e.a.x - e.b.x);
    const double along = dot64(n, towards);
    precise double facing = along * abs(along) / dot64(n, n);
    const bool is_better = facing > farthest;
    farthest = is_better ? facing : farthest;
    best = is_better ? n : best;
  }
  return best;
}

/// Returns whether all edges of q are beyond those of p along `axis`.
bool is_beyond(Placed p, Placed q, dvec2 d, dvec2 axis) {
  double p_most = -SF_INFINITY, q_least = SF_INFINITY;
  for (int i = 0; may_turn(1u) && i < p.count; ++i) {
    const Edge e = edge_of(p, i);
    p_most = most(most(p_most, dot64(axis, e.a)), dot64(axis, e.b));
  }
  for (int i = 0; may_turn(1u) && i < q.count; ++i) {
    const Edge f = edge_of(q, i);
    q_least = least(least(q_least, dot64(axis, f.a)), dot64(axis, f.b));
  }
  precise double gap = dot64(axis, d) + q_least - p_most;
  precise double margin = 1e-9LF * (p.radius + q.radius) * (abs(axis.x) + abs(axis.y));
  return gap > margin;
}

/// Tries the direction of the other outline, and the normals of the edges that face each other.
bool are_apart(Placed p, Placed q, dvec2 d) {
  const dvec2 back = minus(dvec2(0.0LF), d);
  bool apart = false;
  for (int k = 0; may_turn(5u) && k < 3 && !apart; ++k) {
    dvec2 axis = d;
    if (k == 1) axis = facing_normal(p, d);
    if (k == 2) axis = minus(dvec2(0.0LF), facing_normal(q, back));
    apart = is_beyond(p, q, d, axis);
  }
  return apart;
}

bool any_inside(Placed chains, dvec2 shift, Placed outer) {
  bool found = false;
  precise double square = outer.radius * outer.radius;
  Edge before;
  for (int i = 0; may_turn(2u) && i < chains.count && !found; ++i) {
    const Edge e = edge_of(chains, i);
    const bool begins = i == 0 || !follows(e, before);
    const dvec2 p = plus(e.a, shift);
    if (begins && dot64(p, p) <= square) found = is_inside(outer, p, e.z_min, e.z_max);
    before = e;
  }
  return found;
}

bool touches(Placed p, Placed q) {
  const dvec2 d = minus(q.origin, p.origin);
  precise double both = (p.radius + q.radius) * (p.radius + q.radius) * (1.0LF + 1e-12LF);
  if (dot64(d, d) > both || are_apart(p, q, d)) return false;
  precise double reach = q.radius * (1.0LF + 1e-12LF);
  bool met = false;
  for (int i = 0; may_turn(2u) && i < p.count && !met; ++i) {
    const Edge e = edge_of(p, i);
    const int count = distance64(d, e.a, e.b) > reach ? 0 : q.count;
    for (int k = 0; may_turn(1u) && k < count && !met; ++k) {
      const Edge f = edge_of(q, k);
      met = overlap(e, f.z_min, f.z_max) && segments_meet(e.a, e.b, plus(f.a, d), plus(f.b, d));
    }
  }
  return met || any_inside(p, minus(dvec2(0.0LF), d), q) || any_inside(q, d, p);
}

bool surely_overlap(FleetFootprint one, FleetFootprint other, double apart, double lift) {
  precise double both = 0.999LF * (one.inner + other.inner);
  if (one.inner == 0.0LF || other.inner == 0.0LF || apart >= both) return false;
  const FleetEdge p = load_FleetEdge(edges, int(one.first)), q = load_FleetEdge(edges, int(other.first));
  precise double top = lift + q.z_max;
  precise double bottom = lift + q.z_min;
  return p.z_min < top && bottom < p.z_max;
}
