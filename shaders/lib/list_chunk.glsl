// A chunk of a list: its entries and their frame.

struct Chunk {
  float nearest;  // [m] lower bound of the distance of these entries and all following ones
  ivec4 entries;  // texels
  vec4 frame;     // offset [m] and heading
  int first_row;  // first exact segment of the entries' mover
};

Chunk chunk_of(uvec4 words, vec2 offset, int base, dvec2 origin) {
  const ListChunk chunk = decode_ListChunk(words);
  vec4 frame = vec4(-offset, 1.0, 0.0);
  int first_row = 0;
  if (kMovers) {
    const bool is_wall = chunk.mover == 0u;
    const MoverRow mover = load_MoverRow(mover_rows, is_wall ? 0 : int(chunk.mover) - 1);
    const vec2 moved = vec2(dvec2(mover.x, mover.y) - origin);
    frame = is_wall ? frame : vec4(moved, mover.cos, mover.sin);
    base = is_wall ? base : int(mover.base);
    first_row = is_wall ? 0 : int(mover.first_row);
  }
  return Chunk(chunk.nearest, base + ivec4(chunk.entries), frame, first_row);
}
