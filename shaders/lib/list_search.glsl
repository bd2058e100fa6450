// Casts the four beams of a lane against lists. This is a 32-bit search that certifies the nearest segment.
//
// Assumes that the lists contain every segment that a beam could hit, from near to far, and that directions have unit
// length. A segment is m + u e, u in [-1, 1], seen from its right. With w = m - o and a beam o + t d:
//   1 / t = (e x d) / (e x w),  u = -(d x w) / (e x d).
// As on the host (raycast/rasterizer.h derives the errors), each beam keeps bounds of 1 / t: the largest upper bound of
// all segments that may cover it, with the lower bound of the same segment if it certainly covers the beam, and the
// largest upper bound of all others. If the lower bound exceeds the largest upper bound of the others, the segment is
// certified as the nearest.

// Four beams and their nearest segments so far.
struct Search {
  vec4 dx, dy;
  vec4 most, low, others;  // [1/m]
  ivec4 entry;             // texel, or -1
  ivec4 first_row;         // first exact segment of the entry's mover
};

#include "shaders/lib/list_chunk.glsl"

vec2 turned(vec2 by, vec2 v) { return kMovers ? vec2(by.x * v.x - by.y * v.y, by.y * v.x + by.x * v.y) : v; }

// @param live false: the chunk has no effect
void search_chunk(Chunk chunk, float band, bool live, inout Search s) {
  for (int k = 0; k < SF_CHUNK; ++k) {
    const ListEntry entry = load_ListEntry(lists, chunk.entries[k]);
    const vec2 w = chunk.frame.xy + turned(chunk.frame.zw, vec2(entry.x, entry.y));
    const vec2 e = turned(chunk.frame.zw, vec2(entry.ex, entry.ey));
    const float len = abs(e.x) + abs(e.y);
    const float error_margin = band * len;
    const float ahead = live ? e.x * w.y - e.y * w.x : -1e30;
    const bool edge_on = abs(ahead) <= error_margin;
    const float inverse = ahead > error_margin ? 1.0 / ahead : 0.0;
    const float h = len * inverse;
    // An edge-on segment may cover every beam of the sector, at any range.
    const float error = edge_on ? 1e20 : h * (2.0 * band * h + 1.4e-6);
    const float twice = 2.0 * error;
    const float tolerance = edge_on ? 1e30 : 2.0 * band;
    const vec4 aside = s.dx * w.y - s.dy * w.x;
    const vec4 below = e.x * s.dy - e.y * s.dx;
    const vec4 inside = below - abs(aside);
    const vec4 high = mix(vec4(0.0), below * inverse + error, greaterThanEqual(inside, vec4(-tolerance)));
    const vec4 low = mix(vec4(-1.0), high - twice, greaterThanEqual(inside, vec4(tolerance)));
    const bvec4 first = greaterThan(high, s.most);
    const vec4 beaten = mix(high, s.most, first);
    s.others = mix(s.others, beaten, greaterThan(beaten, s.others));
    s.most = mix(s.most, high, first);
    s.low = mix(s.low, low, first);
    s.entry = mix(s.entry, ivec4(chunk.entries[k]), first);
    if (kMovers) s.first_row = mix(s.first_row, ivec4(chunk.first_row), first);
  }
}

// Returns true if every beam has a certain hit nearer than `nearest` [m].
bool all_nearer(Search s, float nearest) { return all(greaterThan(nearest * s.low, vec4(1.0001))); }

// Searches the walls, then the movers, until no remaining entry can be nearer. A single loop that all lanes leave
// together handles both: lavapipe runs the body of other loops once more after the last lane has left.
void search_lists(ListHead walls, ListHead movers, vec2 offset, dvec2 origin, float band, inout Search s) {
  bool at_walls = walls.count > 0u;
  int at = int(at_walls ? walls.first : movers.first);
  int end = at + int(at_walls ? walls.count : movers.count);
  const uvec4 first_mover = kMovers ? imageLoad(lists, int(movers.first)) : uvec4(0u);
  uvec4 words = at_walls ? imageLoad(lists, at) : first_mover;
  bool more = at < end;
  do {
    search_chunk(chunk_of(words, offset, int(walls.base), origin), band, more, s);
    ++at;
    words = imageLoad(lists, at);
    more = more && at < end && !all_nearer(s, decode_ListChunk(words).nearest);
    if (kMovers) {
      const bool turn = !more && at_walls;
      at_walls = at_walls && !turn;
      at = turn ? int(movers.first) : at;
      end = turn ? int(movers.first + movers.count) : end;
      words = turn ? first_mover : words;
      more = more || (turn && movers.count > 0u && !all_nearer(s, decode_ListChunk(first_mover).nearest));
    }
  } while (subgroupAny(more));
}
