// Which cells of one word a scan covers: freed by a beam's line, or occupied by its end. In whole numbers, as
// maps/plain_mapper.h has the rule; bearings only choose which beams are asked.
//
// Of a beam with ends (D, d) along its longer and its shorter side, n = |D|, a = |d|: step i of [0, n] lies
// q = floor((2 i a + n) / (2 n)) to the side. A word holds four neighbouring q for each of four i, so with the least of
// them, w, cell v of [0, 3] is covered where v = floor((2 i a + n - 2 n w) / (2 n)): three comparisons, no division.
//
// The caller declares: rows (MapRow), blocks (MapBlock), ends.

const float PI = 3.14159265;

struct Share {
  int word;        // in the table of all maps; -1: this lane has none
  uint freed;      // bit 2 k of cell k
  uint occupied;   // likewise
};

// Bearing [rad] of a direction, wrong by at most 2e-5 (Abramowitz and Stegun 4.4.49).
float bearing_of(vec2 d) {
  const vec2 a = abs(d);
  const float q = min(a.x, a.y) / max(max(a.x, a.y), 1e-9);
  const float s = q * q;
  const float low = q * (0.9998660 + s * (-0.3302995 + s * (0.1801410 + s * (-0.0851330 + s * 0.0208351))));
  const float quarter = a.y > a.x ? 0.5 * PI - low : low;
  const float half_turn = d.x < 0.0 ? PI - quarter : quarter;
  return d.y < 0.0 ? -half_turn : half_turn;
}

// Beams whose line may touch a word: up to three runs, since a field of view may go round.
struct Candidates {
  int first;   // of the run that lies where the word is
  int count;
  int low;     // as many from beam 0 on
  int high;    // first of those at the other end
};

// `centre` is the middle of the word's cells from the sensor [cells], in the sensor's frame.
// A covered cell's middle lies within one cell of the beam, along columns and along rows: half for its end's cell, half for rounding.
Candidates candidates(vec2 centre, vec4 fan, int beams) {
  const float radius = 3.6;  // sqrt(2) * (1.5 + 1), and a little
  const float distance2 = dot(centre, centre);
  const bool near = distance2 <= radius * radius;
  const float sine = near ? 1.0 : radius * inversesqrt(distance2);
  const float wide = sine + 0.5708 * sine * sine * sine + fan.z;  // >= asin(sine)
  const float bearing = bearing_of(centre);
  const float last = float(beams - 1);
  const float low = near ? 0.0 : (bearing - wide + fan.x) * fan.y;
  const float high = near ? last : (bearing + wide + fan.x) * fan.y;
  const int first = int(ceil(clamp(low, 0.0, last + 1.0)));
  const int end = int(floor(clamp(high, -1.0, last))) + 1;
  Candidates c;
  c.first = first;
  c.count = max(end - first, 0);
  c.low = int(floor(clamp(high - fan.w, -1.0, last))) + 1;
  c.high = int(ceil(clamp(low + fan.w, 0.0, last + 1.0)));
  return c;
}

// Adds what one beam covers of the word whose first cell is `corner` from the sensor's.
void cover(uint end, ivec2 corner, inout Share share) {
  const int dc = bitfieldExtract(int(end), 0, SF_END_BITS);
  const int dr = bitfieldExtract(int(end), SF_END_BITS, SF_END_BITS);
  const bool flat_line = abs(dc) >= abs(dr);
  const int along = flat_line ? dc : dr;
  const int across = flat_line ? dr : dc;
  const int i0 = flat_line ? corner.x : corner.y;
  const int q0 = flat_line ? corner.y : corner.x;
  const int n = abs(along);
  const int a2 = 2 * abs(across);
  const int n1 = max(n, 1);
  const int n2 = 2 * n1;
  const int n4 = 2 * n2;
  const int n6 = n4 + n2;
  const int n8 = 2 * n4;
  const bool back = along < 0;
  const bool down = across < 0;
  int i = back ? -i0 : i0;
  const int step = back ? -1 : 1;
  int g = a2 * i + n1 - n2 * (down ? -(q0 + 3) : q0);
  const int more = back ? -a2 : a2;
  const int per_i = flat_line ? 2 : 8;
  const int per_q = flat_line ? 8 : 2;
  int at = down ? 3 * per_q : 0;
  const int by = down ? -per_q : per_q;
  for (int t = 0; t < 4; ++t) {
    const bool there = i >= 0 && i <= n && g >= 0 && g < n8;
    const int shift = at + (g >= n2 ? by : 0) + (g >= n4 ? by : 0) + (g >= n6 ? by : 0);
    share.freed |= there ? 1u << shift : 0u;
    i += step;
    g += more;
    at += per_i;
  }
  const ivec2 p = ivec2(dc, dr) - corner;
  const bool here = (end & (1u << SF_END_HIT)) != 0u && (p.x | p.y) >= 0 && (p.x | p.y) < 4;
  share.occupied |= here ? 1u << ((8 * p.y + 2 * p.x) & 31) : 0u;
}

Share cover_word(int lane) {
  const int block = lane / SF_MAP_BLOCK;
  const int row = SF_MAP_ROW_TEXELS * int(imageLoad(blocks, 2 * block).x);
  const uint place = imageLoad(blocks, 2 * block + 1).x;
  const uvec4 map = imageLoad(rows, row);
  const uvec4 scan = imageLoad(rows, row + 1);
  const vec4 look = uintBitsToFloat(imageLoad(rows, row + 2));
  const vec4 fan = uintBitsToFloat(imageLoad(rows, row + 3));
  const ivec2 at = ivec2(int(place & 0xFFFFu) + lane % SF_MAP_BLOCK, int(place >> 16));
  const bool inside = at.x < int(map.z);

  const ivec2 corner = 4 * at - ivec2(scan.yz);
  const vec2 middle = vec2(corner) + 1.5 - look.xy;
  const vec2 centre = vec2(look.z * middle.x - look.w * middle.y, -look.w * middle.x - look.z * middle.y);
  const Candidates c = candidates(centre, fan, int(map.w));
  const int ends_first = int(scan.x);
  const int total = inside ? c.count + c.low + max(int(map.w) - c.high, 0) : 0;
  Share share = Share(inside ? int(map.x + uint(at.y) * map.y) + at.x : -1, 0u, 0u);
  int j = 0;
  while (j < total) {
    const int k = j < c.count ? c.first + j : j < c.count + c.low ? j - c.count : c.high + (j - c.count - c.low);
    cover(imageLoad(ends, ends_first + k).x, corner, share);
    ++j;
  }
  return share;
}
