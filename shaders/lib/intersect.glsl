// Intersects one beam with one segment in 64 bits. Every operation is `precise` and in a fixed order, so host and
// device results are equal bit by bit.

#include "shaders/lib/exact32.glsl"

struct Beam64 {
  dvec2 origin;
  dvec2 direction;
};

struct ClosestHit {
  double range;  // [m]
  uint id;       // exact segment, or SF_NO_HIT
  vec3 incidence;    // cross product of segment and direction [m]; x and y of the segment [m]
};

// Returns true if the sine of the angle between beam and surface is below `least`.
bool grazes(ClosestHit d, float least) {
  return d.id != SF_NO_HIT && d.incidence.x * d.incidence.x < least * least * dot(d.incidence.yz, d.incidence.yz);
}

// Returns a segment [m]; any values for SF_NO_HIT.
ExactSegment segment_at(uint id) { return load_ExactSegment(segments, int(id == SF_NO_HIT ? 0u : id)); }

// All segments that share an end use the same doubles for it, so no beam passes between two neighbours.
void intersect(uint id, Beam64 beam, inout ClosestHit best) {
  const ExactSegment s = segment_at(id);

  precise double wax = s.ax - beam.origin.x;
  precise double way = s.ay - beam.origin.y;
  precise double wbx = s.bx - beam.origin.x;
  precise double wby = s.by - beam.origin.y;
  precise double side_a = beam.direction.x * way - beam.direction.y * wax;
  precise double side_b = beam.direction.x * wby - beam.direction.y * wbx;
  precise double ex = s.bx - s.ax;
  precise double ey = s.by - s.ay;
  precise double numerator = ex * way - ey * wax;
  precise double denominator = ex * beam.direction.y - ey * beam.direction.x;
  precise double t = numerator / denominator;

  const bool crosses = (side_a >= 0.0LF && side_b <= 0.0LF) || (side_a <= 0.0LF && side_b >= 0.0LF);
  const bool into = denominator > 0.0LF;
  const bool ahead = t > SF_CONTACT_DISTANCE || (into && t >= -SF_CONTACT_DISTANCE);
  t = t > 0.0LF ? t : 0.0LF;
  const bool first = t < best.range || (t == best.range && id < best.id);
  if (id != SF_NO_HIT && denominator != 0.0LF && crosses && ahead && first) {
    best.range = t;
    best.id = id;
    best.incidence = vec3(denominator, ex, ey);
  }
}

// Returns the range [m] of a beam that is certain to hit segment `id`, as in `intersect`; `range_max` for SF_NO_HIT.
double exact_range(uint id, Beam64 beam, double range_max) {
  const ExactSegment s = segment_at(id);
  precise double wax = s.ax - beam.origin.x;
  precise double way = s.ay - beam.origin.y;
  precise double ex = s.bx - s.ax;
  precise double ey = s.by - s.ay;
  precise double numerator = ex * way - ey * wax;
  precise double denominator = ex * beam.direction.y - ey * beam.direction.x;
  precise double t = numerator / denominator;
  return id == SF_NO_HIT ? range_max : t;
}

// Returns the range [m] of a beam that hits segment `id`, in 32 bits; negative if 32 bits are not accurate enough.
// raycast/intersect.h derives the bound.
float range_single(uint id, Beam64 beam, float range_max) {
  const ExactSegment s = segment_at(id);
  precise float wx = float(s.ax - beam.origin.x), wy = float(s.ay - beam.origin.y);
  precise float ex = float(s.bx - s.ax), ey = float(s.by - s.ay);
  precise float dx = float(beam.direction.x), dy = float(beam.direction.y);
  precise float denominator = ex * dy - ey * dx;
  precise float numerator = ex * wy - ey * wx;
  precise float error_scale = 1.9073486328125e-6 * (abs(ex) + abs(ey)) * (abs(wx) + abs(wy) + range_max);
  precise float limit = SF_SINGLE_TOLERANCE * range_max * abs(denominator);
  precise float t = quotient32(numerator, denominator);
  return id != SF_NO_HIT && error_scale <= limit ? max(t, 0.0) : -1.0;
}
