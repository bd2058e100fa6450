// Walks a ray through the road raster (sensors/lane_markings/marking_raster.h): cell by cell near paint, by whole empty
// squares elsewhere.
//
// Based on J. Amanatides and A. Woo, "A fast voxel traversal algorithm for ray tracing", Eurographics 1987. The squares
// are given by the chessboard distance between blocks, and are aligned squares of 2 or 4 cells within a block. Cell
// indices are exact integers. 32-bit floats, relative to the sensor's cell, only decide the order of crossings. A ray
// that passes a cell's corner within 1e-7 of its length may take either side: rounding as on the host makes it the same
// one on every device.

#include "shaders/lib/exact32.glsl"

// The words of a cell and their contents.
struct Cell {
  bool inside;   // inside the raster
  bool full;     // its block has paint
  uint word;     // directory word
  int bits;      // row of its word of paint in `blocks`
  uint painted;  // 0 or 1
  int clear;     // [cells] side of the empty square around a free cell of a full block: 1, 2 or 4
};

Cell cell_at(ivec2 at, ivec2 size) {
  const ivec2 block = at >> 3;
  Cell c;
  c.inside = at.x >= 0 && at.y >= 0 && block.x < size.x && block.y < size.y;
  c.word = imageLoad(directory, c.inside ? block.y * size.x + block.x : 0).x;
  c.full = c.inside && (c.word & 0x80000000u) != 0u;
  c.bits = c.full ? 4 * int(c.word & 0x7FFFFFFFu) + ((at.y & 7) >> 2) : 0;
  const uint half_block = c.full ? imageLoad(blocks, c.bits).x : 0u;
  c.painted = (half_block >> (((at.y & 3) << 3) | (at.x & 7))) & 1u;
  const uint quarter = half_block & (0x0F0F0F0Fu << (at.x & 4));
  const uint pairs = half_block & (0x0303u << (((at.y & 2) << 3) | (at.x & 6)));
  c.clear = quarter == 0u ? 4 : pairs == 0u ? 2 : 1;
  return c;
}

struct Walk {
  bool met;
  bool across_x;  // the edge that was hit is at constant x
  int face;       // its coordinate, relative to the sensor's cell [cells]
  ivec2 paint;    // the painted cell at that edge
};

// Walks from `from` in cell `start` along `d`, until paint begins (or ends, if the sensor starts on paint) or `reach`
// [cells].
Walk walk(ivec2 start, vec2 from, vec2 d, float reach, ivec2 size, bool going) {
  const vec2 inverse = vec2(d.x == 0.0 ? 1e30 : quotient32(1.0, d.x), d.y == 0.0 ? 1e30 : quotient32(1.0, d.y));
  const uint wanted = 1u - cell_at(start, size).painted;
  Walk w = Walk(false, false, 0, start);
  ivec2 at = start;
  while (going) {
    const Cell c = cell_at(at, size);
    const bool met = c.painted == wanted;
    const int clear = c.full || wanted == 0u || !c.inside ? 0 : int(c.word);
    const ivec2 block = at >> 3;
    const int side = wanted == 0u ? 1 : c.clear;
    const ivec2 low = clear > 0 ? (block - (clear - 1)) << 3 : at & -side;
    const ivec2 high = clear > 0 ? (block + clear) << 3 : low + side;
    const ivec2 exit = ivec2(d.x > 0.0 ? high.x : low.x, d.y > 0.0 ? high.y : low.y) - start;
    precise vec2 t = (vec2(exit) - from) * inverse;
    const bool across_x = d.x != 0.0 && (d.y == 0.0 || t.x < t.y);
    const float out_at = across_x ? t.x : t.y;
    precise vec2 left_at = from + out_at * d;
    const ivec2 beside = clamp(ivec2(floor(left_at)) + start, low, high - 1);
    const ivec2 beyond = ivec2(d.x > 0.0 ? high.x : low.x - 1, d.y > 0.0 ? high.y : low.y - 1);
    const ivec2 next = across_x ? ivec2(beyond.x, beside.y) : ivec2(beside.x, beyond.y);
    going = !met && c.inside && out_at < reach;
    w.met = met && c.inside;
    w.paint = met == (wanted == 1u) ? at : w.paint;
    w.across_x = going ? across_x : w.across_x;
    w.face = going ? (across_x ? exit.x : exit.y) : w.face;
    at = going ? next : at;
  }
  return w;
}
