// The 64-bit word on one beam and one segment. Every operation is `precise` and in one order: host and device agree to the bit.

struct Beam64 {
  dvec2 origin;
  dvec2 direction;
};

struct Decision {
  double range;  // [m]
  uint id;       // exact segment, or SF_NO_HIT
  vec3 slant;    // cross product of the segment and the beam; the segment [m]
};

// True where the sine of the angle between beam and surface is below `least`.
bool grazes(Decision d, float least) {
  return d.id != SF_NO_HIT && d.slant.x * d.slant.x < least * least * dot(d.slant.yz, d.slant.yz);
}

// Both ends use the same doubles for every segment that shares them, so no beam slips between two neighbours.
void decide(uint id, Beam64 beam, inout Decision best) {
  const int row = 2 * int(id == SF_NO_HIT ? 0u : id);
  const uvec4 words_a = imageLoad(segments, row);
  const uvec4 words_b = imageLoad(segments, row + 1);
  const double ax = packDouble2x32(words_a.xy), ay = packDouble2x32(words_a.zw);
  const double bx = packDouble2x32(words_b.xy), by = packDouble2x32(words_b.zw);

  precise double wax = ax - beam.origin.x;
  precise double way = ay - beam.origin.y;
  precise double wbx = bx - beam.origin.x;
  precise double wby = by - beam.origin.y;
  precise double side_a = beam.direction.x * way - beam.direction.y * wax;
  precise double side_b = beam.direction.x * wby - beam.direction.y * wbx;
  precise double ex = bx - ax;
  precise double ey = by - ay;
  precise double above = ex * way - ey * wax;
  precise double below = ex * beam.direction.y - ey * beam.direction.x;
  precise double t = above / below;

  const bool crosses = (side_a >= 0.0LF && side_b <= 0.0LF) || (side_a <= 0.0LF && side_b >= 0.0LF);
  const bool into = below > 0.0LF;
  const bool ahead = t > SF_TOUCH || (into && t >= -SF_TOUCH);
  t = t > 0.0LF ? t : 0.0LF;
  const bool first = t < best.range || (t == best.range && id < best.id);
  if (id != SF_NO_HIT && below != 0.0LF && crosses && ahead && first) {
    best.range = t;
    best.id = id;
    best.slant = vec3(below, ex, ey);
  }
}

// [m] the range of a beam that is known to meet segment `id`, as `decide` has it; `range_max` where it meets none.
double measure(uint id, Beam64 beam, double range_max) {
  const int row = 2 * int(id == SF_NO_HIT ? 0u : id);
  const uvec4 words_a = imageLoad(segments, row);
  const uvec4 words_b = imageLoad(segments, row + 1);
  const double ax = packDouble2x32(words_a.xy), ay = packDouble2x32(words_a.zw);
  const double bx = packDouble2x32(words_b.xy), by = packDouble2x32(words_b.zw);
  precise double wax = ax - beam.origin.x;
  precise double way = ay - beam.origin.y;
  precise double ex = bx - ax;
  precise double ey = by - ay;
  precise double above = ex * way - ey * wax;
  precise double below = ex * beam.direction.y - ey * beam.direction.x;
  precise double t = above / below;
  return id == SF_NO_HIT ? range_max : t;
}

// [m] the range of a beam that meets segment `id`, in 32 bits; less than 0 where these are not close enough. raycast/decide.h has the bound.
float measure_single(uint id, Beam64 beam, float range_max) {
  const int row = 2 * int(id == SF_NO_HIT ? 0u : id);
  const uvec4 words_a = imageLoad(segments, row);
  const uvec4 words_b = imageLoad(segments, row + 1);
  const double ax = packDouble2x32(words_a.xy), ay = packDouble2x32(words_a.zw);
  const double bx = packDouble2x32(words_b.xy), by = packDouble2x32(words_b.zw);
  precise float wx = float(ax - beam.origin.x), wy = float(ay - beam.origin.y);
  precise float ex = float(bx - ax), ey = float(by - ay);
  precise float dx = float(beam.direction.x), dy = float(beam.direction.y);
  precise float below = ex * dy - ey * dx;
  precise float above = ex * wy - ey * wx;
  precise float rough = 1.9073486328125e-6 * (abs(ex) + abs(ey)) * (abs(wx) + abs(wy) + range_max);
  precise float limit = SF_SINGLE_SHARE * range_max * abs(below);
  precise float t = above / below;
  return id != SF_NO_HIT && rough <= limit ? max(t, 0.0) : -1.0;
}
