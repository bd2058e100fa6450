// Rasterizes movers, near to far, without lists.
// Compiled once per instruction set (hwy/foreach_target.h).

#if defined(SF_RAYCAST_MOVERS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SF_RAYCAST_MOVERS_INL_H
#undef SF_RAYCAST_MOVERS_INL_H
#else
#define SF_RAYCAST_MOVERS_INL_H
#endif

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "raycast/rasterizer/walls-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sf::raycast::HWY_NAMESPACE {

/// Lists the movers in grid entries [from, end) that are in range, in view and not behind walls.
void find_movers_in_row(Scratch& s, const Projection& p, const ScanView& view, const ScanPattern& pattern,
                        const ScanScene& scene, std::uint32_t from, std::uint32_t end) {
  const MoverGrid& grid = *scene.movers;
  const VF x = constant(static_cast<float>(view.origin.x - grid.low.x)),
           y = constant(static_cast<float>(view.origin.y - grid.low.y));
  const VF reach = constant(s.horizon * 1.00001f), tolerance = constant(grid.error) + p.band;
  for (std::uint32_t at = from; at < end; at += lanes()) {
    const VF dx = load(&grid.x[at]) - x, dy = load(&grid.y[at]) - y;
    const VF radius = load(&grid.radius[at]) * constant(1.0001f) + tolerance;
    const VF ahead = p.heading_cos * dx + p.heading_sin * dy, left = p.heading_cos * dy - p.heading_sin * dx;
    const VF distance = hn::Sqrt(ahead * ahead + left * left);
    // A mover's edges are within its disc, and at least `inner` away from its origin.
    const VF inside = load(&grid.inner[at]) * constant(0.9999f) - tolerance - distance;
    const VF gap = distance - radius, apart = hn::Max(gap, inside);
    MF seen = apart <= reach;
    if (p.narrow) {
      seen = hn::And(seen, p.edge_sin * ahead - p.edge_cos * left >= hn::Neg(radius));
      seen = hn::And(seen, p.edge_sin * ahead + p.edge_cos * left >= hn::Neg(radius));
    }
    std::uint32_t pending = bits_of(seen);
    if (end - at < lanes()) pending &= (1u << (end - at)) - 1;
    if (pending == 0) continue;
    VF unused;
    const VF place = bearing_of(left, ahead, unused) * p.per_radian + p.middle;
    // asin(v) <= v + v^3 / 6 + 3 v^5 / 40 + v^7 / 5 up to v = 0.8.
    const VF v = radius / hn::Max(distance, constant(1e-30f)), vv = v * v;
    const VF turned =
        v * (constant(1.0f) + vv * (constant(0.16666667f) + vv * (constant(0.075f) + vv * constant(0.2f))));
    const MF around = v > constant(0.8f);
    const VF wide = hn::IfThenElse(
        around, p.turn, (turned * constant(1.0001f) + constant(4e-6f)) * p.per_radian + p.slack + constant(0.01f));
    HWY_ALIGN float nearest[kBlock], lows[kBlock], highs[kBlock];
    store(apart, nearest), store(place - wide, lows), store(place + wide, highs);
    const std::uint32_t outside = bits_of(gap > constant(1e-4f));
    for (; pending != 0; pending &= pending - 1) {
      const auto i = static_cast<std::uint32_t>(__builtin_ctz(pending));
      if (grid.skips(at + i, scene.self) || scene.in_crowd(grid.mover[at + i])) continue;
      ++s.counts.movers_in_range;
      if (may_be_visible(s, pattern, p.full, lows[i], highs[i], nearest[i]))
        s.near.push_back({nearest[i], lows[i], highs[i], grid.mover[at + i], (outside >> i & 1) != 0});
    }
  }
}

void find_movers_in_view(Scratch& s, const Projection& p, const ScanView& view, const ScanPattern& pattern,
                         const ScanScene& scene) {
  const MoverGrid& grid = *scene.movers;
  const double reach =
      static_cast<double>(s.horizon) * 1.00001 + grid.largest_radius + 2.0 * static_cast<double>(grid.error);
  const glm::dvec2 v{view.origin.x - grid.low.x, view.origin.y - grid.low.y};
  const int x0 = grid.column_of(v.x - reach), x1 = grid.column_of(v.x + reach);
  const std::uint32_t copy = grid.copies.copy_of(scene.self);
  s.near.clear();
  for (int row = grid.row_of(v.y - reach, copy); row <= grid.row_of(v.y + reach, copy); ++row)
    find_movers_in_row(s, p, view, pattern, scene, grid.begin_of(x0, row), grid.begin_of(x1 + 1, row));
}

/// Projects a mover's edges. @param sink called with each projected block
template <class Sink>
HWY_INLINE void project_mover(Scratch& s, const Projection& p, const ScanView& view, const ScanScene& scene,
                              const NearMover& near, Sink sink) {
  const OutlineTable::Outline& outline = scene.outline_of(near.mover);
  const base::Pose& X = scene.states[near.mover].X_WM;
  const VF c = constant(static_cast<float>(scene.headings[near.mover].x)),
           sn = constant(static_cast<float>(scene.headings[near.mover].y));
  const VF x = constant(static_cast<float>(X.x - view.origin.x)), y = constant(static_cast<float>(X.y - view.origin.y));
  const std::uint32_t count = near.outside ? outline.outward : outline.all;
  s.counts.blocks += count;
  for (std::uint32_t i = outline.first; i < outline.first + count; ++i) {
    const SegmentBlock& block = scene.outlines->blocks[i];
    ProjectedBlock projected;
    for (std::uint32_t k = 0; k < kBlock; k += lanes()) {
      const VF ax = load(block.ax + k), ay = load(block.ay + k), ex = load(block.ex + k), ey = load(block.ey + k);
      project(projected, p, x + (c * ax - sn * ay), y + (sn * ax + c * ay), c * ex - sn * ey, sn * ex + c * ey,
              block.row + k, scene.first_rows[near.mover]);
    }
    sink(projected);
  }
}

void rasterize_movers(Scratch& s, const Projection& p, const ScanView& view, const ScanPattern& pattern,
                      const ScanScene& scene) {
  find_movers_in_view(s, p, view, pattern, scene);
  s.order.clear();
  for (std::uint32_t i = 0; i < s.near.size(); ++i) {
    const float distance = std::max(s.near[i].distance, 0.0f);
    std::uint32_t word;
    std::memcpy(&word, &distance, sizeof word);
    s.order.push_back(std::uint64_t{word} << 32 | i);
  }
  std::sort(s.order.begin(), s.order.end());
  std::uint32_t visible = 0;
  for (const std::uint64_t key : s.order) {
    const NearMover& near = s.near[key & 0xFFFFFFFFu];
    if (near.distance > s.horizon) break;
    if (!may_be_visible(s, pattern, p.full, near.low, near.high, near.distance)) continue;
    project_mover(s, p, view, scene, near, Draw{s, pattern});
    if (++visible >= kCrowd && std::has_single_bit(visible)) s.horizon = horizon_of(s, pattern);
  }
  s.counts.movers_visible += visible;
}

}  // namespace sf::raycast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
