// Finds the pairs of beams that may lie in a range of bearings. Bearings only select the beams to test: too many
// candidates cost time but never change a cell.

const float PI = 3.14159265;

// Returns the bearing of a direction [rad] with an error of up to 2e-5 (Abramowitz and Stegun 4.4.49).
float bearing_of(vec2 d) {
  const vec2 a = abs(d);
  const float q = min(a.x, a.y) / max(max(a.x, a.y), 1e-9);
  const float s = q * q;
  const float low = q * (0.9998660 + s * (-0.3302995 + s * (0.1801410 + s * (-0.0851330 + s * 0.0208351))));
  const float quarter = a.y > a.x ? 0.5 * PI - low : low;
  const float half_turn = d.x < 0.0 ? PI - quarter : quarter;
  return d.y < 0.0 ? -half_turn : half_turn;
}

// Up to three runs of pairs, because a field of view may wrap around.
struct Candidates {
  int first;   // first pair of the main run
  int count;
  int low;     // length of the run that begins at pair 0
  int high;    // first pair of the run that ends at the last pair
};

int count_of(Candidates c, int pairs) { return c.count + c.low + max(pairs - c.high, 0); }

// Returns the j-th candidate.
int candidate(Candidates c, int j) {
  return j < c.count ? c.first + j : j < c.count + c.low ? j - c.count : c.high + (j - c.count - c.low);
}

// Returns the candidates within `wide` of `bearing` (in [-pi, pi], sensor frame), or all pairs. Pair p holds beams 2 p
// and 2 p + 1, half a pair apart.
Candidates candidates(float bearing, float wide, bool all, MapRow scan) {
  const int pairs = int(scan.pairs);
  const float last = float(pairs);
  const float reach = wide + scan.slack;
  const float low = (bearing - reach + scan.half_fov) * scan.per_radian - 0.5;
  const float high = (bearing + reach + scan.half_fov) * scan.per_radian;
  const int first = all ? 0 : int(ceil(clamp(low, 0.0, last)));
  const int end = all ? pairs : int(floor(clamp(high, -1.0, last - 1.0))) + 1;
  Candidates c;
  c.first = first;
  c.count = max(end - first, 0);
  c.low = all ? 0 : int(floor(clamp(high - scan.round, -1.0, last - 1.0))) + 1;
  c.high = all ? pairs : int(ceil(clamp(low + scan.round, 0.0, last)));
  return c;
}
