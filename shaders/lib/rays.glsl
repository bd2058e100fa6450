// Casting the four beams of a lane against sector lists: a 32-bit search that proves its winner, a 64-bit decision.
//
// Assumes lists that hold every segment that could be met, near to far (raycast/sectors.h), and directions of unit length.
// A segment is a + u e, u in [0, 1], seen from its right; with w = a - o and a beam o + t d:
//   t = (e x w) / (e x d),  u = (d x w) / (e x d).
// Near-to-far order is by a lower bound of t: (e x w - E) / (e x d), where E bounds what rounding did (SF_BAND).
//
// Proof of the winner. True t of any other is at least the winner's lower bound, so another surface could only come first
// within tau = 2 E / (e x d) before the winner's. None does when tau is below the clearance of what was met, the beam passes its ends by more than
// rounding and by 4 tau (neighbours at its ends leave at 15 degrees or more, and 1 / sin 15 < 4), and no
// segment was seen edge-on. Otherwise every segment that might be first is decided in 64 bits.

// A proven beam does not graze: its margins leave e x d >= 2 (4 tau) = 16 E / (e x d), and with E = SF_BAND A |e|, |e| <= 2 A, a sine of
// sqrt(8 SF_BAND) = 2.7e-3 at least.

struct Beams {
  vec4 dx;
  vec4 dy;
};

// The nearest so far, as fractions: no division in the loop.
struct Nearest {
  vec4 above;      // lower bound of t, numerator; positive
  vec4 below;      // denominator; positive
  ivec4 entry;     // row of `entries`, or -1
  bool edge_on;    // some segment's line passes through the sensor within rounding
};

void search_chunk(int chunk, vec2 o, Beams d, float band, inout Nearest best) {
  for (int k = 0; k < SF_CHUNK; ++k) {
    const int entry = SF_CHUNK * chunk + k;
    const vec4 s = imageLoad(entries, entry);
    const vec2 w = s.xy - o;
    const float error = band * (abs(s.z) + abs(s.w));
    const float ahead = s.z * w.y - s.w * w.x;
    best.edge_on = best.edge_on || abs(ahead) <= error;
    const float above = ahead > error ? ahead - error : 1e30;
    const vec4 c = d.dx * w.y - d.dy * w.x;
    const vec4 below = s.z * d.dy - s.w * d.dx;
    const bvec4 met = bvec4(uvec4(greaterThanEqual(c, vec4(-band))) & uvec4(lessThanEqual(c, below + band)) &
                            uvec4(lessThan(above * best.below, best.above * below)));
    best.above = mix(best.above, vec4(above), met);
    best.below = mix(best.below, below, met);
    best.entry = mix(best.entry, ivec4(entry), met);
  }
}

// Searches the walls, then the movers, near to far, until nothing that is left can be nearer. `o` is the sensor in the frame of the walls'
// entries, then of the movers'. One loop for both: lavapipe runs a loop's body once more, in vain, after the last lane has left.
void search_lists(uvec4 walls, uvec4 movers, vec4 o, Beams d, float band, inout Nearest best) {
  bool at_walls = walls.y > 0u;
  int chunk = int(at_walls ? walls.x : movers.x);
  int end = chunk + int(at_walls ? walls.y : movers.y);
  bool more = chunk < end;
  while (more) {
    search_chunk(chunk, at_walls ? o.xy : o.zw, d, band, best);
    ++chunk;
    more = chunk < end && any(greaterThan(best.above, imageLoad(nearest, chunk).x * best.below));
    const bool turn = !more && at_walls;
    chunk = turn ? int(movers.x) : chunk;
    end = turn ? int(movers.x + movers.y) : end;
    at_walls = at_walls && !turn;
    more = more || (turn && movers.y > 0u);
  }
}

// [m] how near other surfaces come to the segment that a list's word names, at least: a power of two, made of its exponent.
float clearance_of(uint word) { return uintBitsToFloat((SF_NO_CLEARANCE - (word >> SF_ROW_BITS)) << 23); }

struct Proof {
  bool holds;  // the winner of a beam needs no further look
  float tau;   // [m] from the lower to the upper bound of its range
};

// `word` is what the winner's list calls it.
Proof prove(int entry, uint word, vec2 o, vec2 d, float band, float clearance, float below) {
  const vec4 s = imageLoad(entries, max(entry, 0));
  const vec2 w = s.xy - o;
  const float error = 2.0 * band * (abs(s.z) + abs(s.w));
  const float tau = error / below;
  const float c = d.x * w.y - d.y * w.x;
  const float margin = band + 4.0 * tau;
  return Proof(entry < 0 || (c >= margin && c <= below - margin && tau < min(clearance_of(word), clearance)), tau);
}
