// The grid of movers, a hash table of lists: NeighbourGrid in kernels. The order of a list depends on the device, but no
// result depends on it.

/// Position among the movers of some cells.
struct MoverWalk {
  ivec4 cells;   // x and y of the first and of the last
  ivec2 at;      // the next cell
  ivec2 cell;    // the present one
  uint next;     // 1 + the next mover in its bucket
  uint copy;
};

int cell_of(double v) {
  precise double ratio = v / load_FleetTick(tick, 0).cell;
  const double near = limited(ratio, -1e9LF, 1e9LF), whole = nearest64(near);
  return int(whole) - (whole > near ? 1 : 0);
}

ivec2 cell_at(dvec2 p) { return ivec2(cell_of(p.x), cell_of(p.y)); }

int bucket_of(ivec2 cell, uint copy) {
  uint h = uint(cell.x) * 0x9E3779B1u ^ uint(cell.y) * 0x85EBCA77u ^ copy * 0xC2B2AE3Du;
  h = (h ^ h >> 15) * 0x2C1B3C6Du;
  return int((h ^ h >> 13) & (load_FleetTick(tick, 0).buckets - 1u));
}

uint copy_of(int row) { return uint(row) / load_FleetTick(tick, 0).copy_movers; }

/// Begins with the movers of the invocation's copy whose cells were within `reach` of `p` at the start of the tick.
MoverWalk movers_around(dvec2 p, double reach) {
  precise double margin = reach + 1e-6LF;  // for rounding
  precise dvec2 low = p - margin;
  precise dvec2 high = p + margin;
  const ivec2 first = cell_at(low), last = cell_at(high);
  return MoverWalk(ivec4(first, last), first, first, 0u, copy_of(own_row));
}

/// Returns the next row, each once; -1 at the end.
int next_mover(inout MoverWalk walk) {
  int found = -1;
  while (may_turn(1u) && found < 0 && (walk.next != 0u || walk.at.y <= walk.cells.w)) {
    if (walk.next != 0u) {
      const int row = int(walk.next) - 1;
      const FleetPlace place = load_FleetPlace(places, row);
      found = place.x == walk.cell.x && place.y == walk.cell.y && place.copy == walk.copy ? row : -1;
      walk.next = place.next;
    } else {
      walk.cell = walk.at;
      walk.next = imageLoad(buckets, bucket_of(walk.cell, walk.copy)).x;
      const bool is_last = walk.at.x == walk.cells.z;
      walk.at = is_last ? ivec2(walk.cells.x, walk.at.y + 1) : ivec2(walk.at.x + 1, walk.at.y);
    }
  }
  return found;
}
