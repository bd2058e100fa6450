// Planar geometry in 64 bits: base/pose.h, world/wall_tree.h and the vectors of GLM, with the same operations in the
// same order.

#include "shaders/lib/elementary64.glsl"

double dot64(dvec2 p, dvec2 q) {
  precise double sum = p.x * q.x + p.y * q.y;
  return sum;
}

double cross64(dvec2 p, dvec2 q) {
  precise double area = p.x * q.y - p.y * q.x;
  return area;
}

double length64(dvec2 v) {
  precise double size = sqrt(dot64(v, v));
  return size;
}

dvec2 minus(dvec2 p, dvec2 q) {
  precise dvec2 d = p - q;
  return d;
}

dvec2 plus(dvec2 p, dvec2 q) {
  precise dvec2 sum = p + q;
  return sum;
}

/// Turns `p` by an angle with the given sine and cosine.
dvec2 turned(dvec2 p, double sine, double cosine) {
  precise dvec2 q = dvec2(cosine * p.x - sine * p.y, sine * p.x + cosine * p.y);
  return q;
}

dvec2 unit64(dvec2 v) {
  const double size = length64(v);
  precise double inverse = 1.0LF / size;
  precise dvec2 u = inverse * v;
  return size > 0.0LF ? u : dvec2(0.0LF);
}

/// Returns the vector [m] from the segment's nearest point to `p`.
dvec2 from_segment(dvec2 p, dvec2 a, dvec2 b) {
  precise dvec2 along = b - a;
  const double size = dot64(along, along);
  precise double ratio = dot64(minus(p, a), along) / size;
  precise double t = size > 0.0LF ? limited(ratio, 0.0LF, 1.0LF) : 0.0LF;
  precise dvec2 d = (p - a) - t * along;
  return d;
}

double distance64(dvec2 p, dvec2 a, dvec2 b) { return length64(from_segment(p, a, b)); }

bool is_within(double p, double a, double b) { return least(a, b) <= p && p <= most(a, b); }
bool is_on(dvec2 p, dvec2 q, dvec2 r) { return is_within(p.x, q.x, r.x) && is_within(p.y, q.y, r.y); }

bool segments_meet(dvec2 a, dvec2 b, dvec2 c, dvec2 d) {
  const double sc = cross64(minus(b, a), minus(c, a)), sd = cross64(minus(b, a), minus(d, a));
  const double sa = cross64(minus(d, c), minus(a, c)), sb = cross64(minus(d, c), minus(b, c));
  if ((sc > 0.0LF && sd > 0.0LF) || (sc < 0.0LF && sd < 0.0LF)) return false;
  if ((sa > 0.0LF && sb > 0.0LF) || (sa < 0.0LF && sb < 0.0LF)) return false;
  if (sa != 0.0LF || sb != 0.0LF || sc != 0.0LF || sd != 0.0LF) return true;
  return is_on(a, c, d) || is_on(b, c, d) || is_on(c, a, b);
}
