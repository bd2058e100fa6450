// Decides the uncertain beams of a scan in 64 bits. Compiled once per instruction set (hwy/foreach_target.h).

#if defined(SF_RAYCAST_DECIDE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SF_RAYCAST_DECIDE_INL_H
#undef SF_RAYCAST_DECIDE_INL_H
#else
#define SF_RAYCAST_DECIDE_INL_H
#endif

#include <algorithm>
#include <bit>

#include "raycast/rasterizer/exact-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sf::raycast::HWY_NAMESPACE {

/// Calls `visit(i)` for every uncertain beam.
template <class Visit>
HWY_INLINE void each_uncertain(const Scratch& s, Visit visit) {
  for (std::size_t w = 0; w < s.uncertain.size(); ++w)
    for (std::uint64_t pending = s.uncertain[w]; pending != 0; pending &= pending - 1)
      visit(64 * w + static_cast<std::size_t>(__builtin_ctzll(pending)));
}

/// Sink of projected blocks that intersects uncertain beams with the segments that may be nearest to the viewer.
struct Decide {
  Scratch& s;
  const ScanView& view;
  const ScanPattern& pattern;
  const ScanScene& scene;

  HWY_INLINE void operator()(const ProjectedBlock& block) const {
    for (std::uint32_t i = 0; i < block.count; ++i) decide(block.parts[i]);
  }
  void decide(const Intervals& g) const {
    const std::uint32_t step = lanes();
    const VF first = hn::Load(kF, g.first), last = hn::Load(kF, g.last);
    for (std::uint32_t j = g.from & ~(step - 1); j <= g.end; j += step) {
      const auto open = static_cast<std::uint32_t>(s.uncertain[j >> 6] >> (j & 63)) & ((1u << step) - 1);
      if (open == 0) continue;
      const VF begin = constant(static_cast<float>(j)), end = constant(static_cast<float>(j + step - 1));
      const VF place = load(&pattern.place[j]), cosine = load(&pattern.cos32[j]), sine = load(&pattern.sin32[j]);
      const VF near_low = load(&s.near_low[j]);
      for (std::uint32_t pending = bits_of(hn::And(first <= end, last >= begin)); pending != 0;
           pending &= pending - 1) {
        const auto k = static_cast<std::uint32_t>(__builtin_ctz(pending));
        const MF possible = hn::And(place >= constant(g.low_possible[k]), place <= constant(g.high_possible[k]));
        const VF high = constant(g.a[k]) * cosine + constant(g.b[k]) * sine + constant(g.error[k]);
        const auto row = static_cast<std::uint32_t>(g.row[k]);
        if (row == SF_NO_HIT) continue;
        std::uint32_t met = open & bits_of(hn::And(possible, high >= near_low));
        s.counts.decisions += static_cast<std::uint64_t>(std::popcount(met));
        for (std::uint32_t i = 0; i < step; i += static_cast<std::uint32_t>(hn::Lanes(kD)), met >>= hn::Lanes(kD))
          if ((met & ((1u << hn::Lanes(kD)) - 1)) != 0) intersect_vector(row, j + i);
      }
    }
  }
  /// `intersect` for a vector of beams that starts at `i`, with the same operations in the same order.
  HWY_INLINE void intersect_vector(std::uint32_t row, std::size_t i) const {
    const ExactSegment& g = scene.exact[row];
    const double wax = g.ax - view.origin.x, way = g.ay - view.origin.y;
    const double wbx = g.bx - view.origin.x, wby = g.by - view.origin.y;
    const double ex = g.bx - g.ax, ey = g.by - g.ay;
    const VD x = hn::LoadU(kD, &s.x[i]), y = hn::LoadU(kD, &s.y[i]), zero = hn::Zero(kD);
    const VD side_a = x * hn::Set(kD, way) - y * hn::Set(kD, wax), side_b = x * hn::Set(kD, wby) - y * hn::Set(kD, wbx);
    const auto crosses = hn::Or(hn::And(side_a >= zero, side_b <= zero), hn::And(side_a <= zero, side_b >= zero));
    const VD denominator = hn::Set(kD, ex) * y - hn::Set(kD, ey) * x;
    const VD t = hn::Set(kD, ex * way - ey * wax) / denominator;
    const auto into = hn::And(denominator > zero, t >= hn::Set(kD, -SF_CONTACT_DISTANCE));
    const auto ahead = hn::And(denominator != zero, hn::Or(t > hn::Set(kD, SF_CONTACT_DISTANCE), into));
    const VD range = hn::IfThenElse(t > zero, t, zero), best = hn::LoadU(kD, &s.range[i]);
    const auto number = hn::Set(kRows, static_cast<std::int64_t>(row)), known = hn::LoadU(kRows, &s.row[i]);
    const auto before = hn::And(range == best, hn::RebindMask(kD, number < known));
    const auto nearer = hn::And(hn::And(crosses, ahead), hn::Or(range < best, before));
    hn::StoreU(hn::IfThenElse(nearer, range, best), kD, &s.range[i]);
    hn::StoreU(hn::IfThenElse(hn::RebindMask(kRows, nearer), number, known), kRows, &s.row[i]);
  }
};

/// Intersects the uncertain beams with all segments, segment by segment. For many beams this is faster, since each
/// segment is projected only once.
void decide_segments(Scratch& s, const Projection& p, const ScanView& view, const ScanPattern& pattern,
                     const ScanScene& scene) {
  const std::size_t padded = pattern.beams + kBlock;
  s.x.resize(padded), s.y.resize(padded);
  s.range.assign(padded, view.range_max), s.row.assign(padded, std::int64_t{SF_NO_HIT});
  each_uncertain(s, [&](std::size_t i) {
    const glm::dvec2 d = direction_of(view, pattern, i);
    s.x[i] = d.x, s.y[i] = d.y;
    if (scene.crowd_index == nullptr) return;
    ClosestHit best{view.range_max};
    intersect_crowd(s, view, scene, d, best);
    s.range[i] = best.range, s.row[i] = std::int64_t{best.id};
  });
  const Decide decide{s, view, pattern, scene};
  project_cell(s, p, pattern, scene.crowd, decide);
  project_cell(s, p, pattern, scene.walls, decide);
  const auto walls = static_cast<std::uint32_t>(scene.walls.blocks.size());
  project_blocks(s, p, pattern, scene.walls, scene.walls.front_facing, walls, true, decide);
  for (const std::uint64_t key : s.order) {
    const NearMover& near = s.near[key & 0xFFFFFFFFu];
    if (near.distance > s.horizon) break;
    if (may_be_visible(s, pattern, p.full, near.low, near.high, near.distance))
      project_mover(s, p, view, scene, {near.distance, near.low, near.high, near.mover, false}, decide);
  }
}

/// Intersects the uncertain beams in 64 bits. @return true if any grazes a surface
bool intersect_uncertain_beams(Scratch& s, const Projection& p, const ScanView& view, const ScanPattern& pattern,
                               const ScanScene& scene, const ScanOutput& out) {
  std::fill_n(out.grazes, pattern.beams, std::uint8_t{0});
  std::uint64_t uncertain = 0;
  for (const std::uint64_t word : s.uncertain) uncertain += static_cast<std::uint64_t>(std::popcount(word));
  s.counts.uncertain += uncertain;
  const bool many = uncertain > kMaxSingleDecisions;
  if (many) decide_segments(s, p, view, pattern, scene);
  bool grazes = false;
  each_uncertain(s, [&](std::size_t i) HWY_ATTR {
    const glm::dvec2 d = direction_of(view, pattern, i);
    ClosestHit best{view.range_max};
    if (many) {
      const auto row = static_cast<std::uint32_t>(s.row[i]);
      if (row != SF_NO_HIT) intersect({scene.exact[row], row}, view.origin, d, best);
    } else {
      intersect_crowd(s, view, scene, d, best);
      intersect_cell(s, view, scene, scene.walls, d, best);
      intersect_near_movers(s, view, pattern, scene, pattern.place[i], d, best);
    }
    grazes |= write_beam(view, scene, i, d, best, out);
  });
  return grazes;
}

}  // namespace sf::raycast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
