// Rasterizes the surfaces around a cell: walls, and the edges of a crowd. Compiled once per instruction set
// (hwy/foreach_target.h).

#if defined(SF_RAYCAST_WALLS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SF_RAYCAST_WALLS_INL_H
#undef SF_RAYCAST_WALLS_INL_H
#else
#define SF_RAYCAST_WALLS_INL_H
#endif

#include "raycast/rasterizer/projection-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sf::raycast::HWY_NAMESPACE {

/// Places of the beams that blocks may cover, for one vector of blocks.
struct BlockIntervals {
  HWY_ALIGN float nearest[kBlock], low[kBlock], high[kBlock];
};

/// Projects the bounds of blocks. @return bit mask of those in view
HWY_INLINE std::uint32_t project_bounds(const Projection& p, const BlockBounds* bounds, BlockIntervals& out) {
  VF nearest, bearing, half;
  hn::LoadInterleaved3(kF, &bounds->nearest, nearest, bearing, half);
  VF turned = bearing - constant(p.yaw);  // within two turns
  turned = turned - constant(6.2831853f) * hn::Round(turned * constant(0.15915494f));
  const VF place = turned * p.per_radian + p.middle;
  const VF wide = (half + constant(4e-6f)) * p.per_radian + p.slack + constant(0.01f);
  const MF around = half > constant(3.0f);
  const VF low = hn::IfThenElse(around, constant(-1e30f), place - wide);
  const VF high = hn::IfThenElse(around, constant(1e30f), place + wide);
  hn::Store(nearest, kF, out.nearest), hn::Store(low, kF, out.low), hn::Store(high, kF, out.high);
  const VF first = constant(0.0f), last = constant(p.last);
  const MF ahead = hn::And(low <= last, high >= first);
  const MF before = high - p.turn >= first, behind = low + p.turn <= last;
  return bits_of(hn::Or(ahead, hn::Or(before, behind)));
}

/// Projects the blocks [from, end) of a cell that may be visible, near to far. @param sink called with each
/// @param reversed segments are seen from their left
template <class Sink>
HWY_INLINE void project_blocks(Scratch& s, const Projection& p, const ScanPattern& pattern, const CellBlocks& cell,
                               std::uint32_t from, std::uint32_t end, bool reversed, Sink sink) {
  const VF ox = constant(static_cast<float>(cell.offset.x)), oy = constant(static_cast<float>(cell.offset.y));
  BlockIntervals intervals;
  // Each block is projected before the previous one is passed to the sink, so the CPU can overlap both.
  ProjectedBlock projected[2];
  std::uint32_t spare = 0;
  for (std::uint32_t first = from; first < end; first += lanes()) {
    std::uint32_t pending = project_bounds(p, &cell.bounds[first], intervals);
    if (end - first < lanes()) pending &= (1u << (end - first)) - 1;
    for (; pending != 0; pending &= pending - 1) {
      const auto i = static_cast<std::uint32_t>(__builtin_ctz(pending));
      if (!may_be_visible(s, pattern, p.full, intervals.low[i], intervals.high[i], intervals.nearest[i])) continue;
      const SegmentBlock& block = cell.blocks[first + i];
      const std::uint32_t after = pending & (pending - 1);
      if (after != 0)
        prefetch(&cell.blocks[first + static_cast<std::uint32_t>(__builtin_ctz(after))], sizeof(SegmentBlock));
      ++s.counts.blocks;
      ProjectedBlock& next = projected[spare];
      next.count = 0;
      for (std::uint32_t k = 0; k < kBlock; k += lanes()) {
        const VF ax = load(block.ax + k) - ox, ay = load(block.ay + k) - oy;
        const VF ex = load(block.ex + k), ey = load(block.ey + k);
        if (reversed)
          project(next, p, ax + ex, ay + ey, hn::Neg(ex), hn::Neg(ey), block.row + k, 0);
        else
          project(next, p, ax, ay, ex, ey, block.row + k, 0);
      }
      spare ^= 1;
      sink(projected[spare]);
    }
  }
  sink(projected[spare ^ 1]);
}

/// Projects the surfaces that face a cell.
template <class Sink>
HWY_INLINE void project_cell(Scratch& s, const Projection& p, const ScanPattern& pattern, const CellBlocks& cell,
                             Sink sink) {
  project_blocks(s, p, pattern, cell, 0, cell.front_facing, false, sink);
}

}  // namespace sf::raycast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
