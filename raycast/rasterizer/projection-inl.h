// Projects segments to intervals of beams. raycast/rasterizer.h derives the errors.
// Compiled once per instruction set (hwy/foreach_target.h).

#if defined(SF_RAYCAST_PROJECTION_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SF_RAYCAST_PROJECTION_INL_H
#undef SF_RAYCAST_PROJECTION_INL_H
#else
#define SF_RAYCAST_PROJECTION_INL_H
#endif

#include <cmath>

#include "raycast/rasterizer/intervals-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sf::raycast::HWY_NAMESPACE {

/// Constants of one scan's projection.
struct Projection {
  VF heading_cos, heading_sin;
  VF per_radian, middle, slack, turn;
  VF band;
  float last, full, yaw;
  bool narrow;
  VF edge_cos, edge_sin;
};

Projection projection_of(const ScanView& view, const ScanPattern& pattern) {
  const float turn = 6.2831853f * pattern.per_radian;
  return {constant(static_cast<float>(view.heading.x)),
          constant(static_cast<float>(view.heading.y)),
          constant(pattern.per_radian),
          constant(pattern.middle),
          constant(pattern.slack),
          constant(turn),
          constant(view.band),
          static_cast<float>(pattern.beams - 1),
          turn,
          static_cast<float>(base::wrap_angle(view.yaw)),
          pattern.narrow,
          constant(pattern.edge_cos),
          constant(pattern.edge_sin)};
}

/// The projected segments of one block. A segment may cover beams at both ends of the view.
struct ProjectedBlock {
  Intervals parts[3 * kBlock / hn::MaxLanes(kF)];
  std::uint32_t count = 0;  ///< number of parts in use
};

/// Appends the segments of `mask` whose intervals contain beams.
HWY_INLINE void append_intervals(ProjectedBlock& out, const Projection& p, MF mask, VF low_possible, VF high_possible,
                                 VF low_certain, VF high_certain, VF a, VF b, VF error, hn::Vec<decltype(kI)> row) {
  const VF first = hn::Max(hn::Floor(low_possible - p.slack), constant(0.0f));
  const VF last = hn::Min(hn::Ceil(high_possible + p.slack), constant(p.last));
  const MF in_view = hn::And(mask, first <= last);
  if (hn::AllFalse(kF, in_view)) return;
  Intervals& g = out.parts[out.count++];
  hn::Store(a, kF, g.a), hn::Store(b, kF, g.b), hn::Store(error, kF, g.error), hn::Store(row, kI, g.row);
  hn::Store(low_possible, kF, g.low_possible), hn::Store(high_possible, kF, g.high_possible);
  hn::Store(low_certain, kF, g.low_certain), hn::Store(high_certain, kF, g.high_certain);
  const VF from = hn::IfThenElse(in_view, first, constant(1e9f)), end = hn::IfThenElse(in_view, last, constant(-1.0f));
  hn::Store(from, kF, g.first), hn::Store(end, kF, g.last);
  g.from = static_cast<std::uint32_t>(hn::GetLane(hn::MinOfLanes(kF, from)));
  g.end = static_cast<std::uint32_t>(hn::GetLane(hn::MaxOfLanes(kF, end)));
}

/// Projects segments that start at (wx, wy) from the viewer and extend by (gx, gy), in world directions.
inline void project(ProjectedBlock& out, const Projection& p, VF wx, VF wy, VF gx, VF gy, const std::uint32_t* rows,
                    std::uint32_t first_row) {
  const VF length = hn::Abs(gx) + hn::Abs(gy);
  const VF error_margin = p.band * length;
  const VF ahead = gx * wy - gy * wx;
  MF seen = ahead > hn::Neg(error_margin);
  const VF ax = p.heading_cos * wx + p.heading_sin * wy, ay = p.heading_cos * wy - p.heading_sin * wx;
  const VF ex = p.heading_cos * gx + p.heading_sin * gy, ey = p.heading_cos * gy - p.heading_sin * gx;
  const VF bx = ax + ex, by = ay + ey;
  if (p.narrow) {
    // Cull segments with both ends beyond the left edge of the view, or both beyond the right one.
    const VF tolerance = constant(-8.0f) * p.band;
    const VF left_a = p.edge_sin * ax - p.edge_cos * ay, left_b = p.edge_sin * bx - p.edge_cos * by;
    const VF right_a = p.edge_sin * ax + p.edge_cos * ay, right_b = p.edge_sin * bx + p.edge_cos * by;
    seen = hn::And(seen, hn::And(hn::Max(left_a, left_b) >= tolerance, hn::Max(right_a, right_b) >= tolerance));
  }
  if (hn::AllFalse(kF, seen)) return;
  VF inverse_a, inverse_b;
  const VF at_a = bearing_of(ay, ax, inverse_a) * p.per_radian + p.middle;
  const VF at_b = bearing_of(by, bx, inverse_b) * p.per_radian + p.middle;
  const VF two_bands = p.band + p.band;
  const VF rounding = constant(2e-6f);
  const VF margin_a = p.per_radian * (two_bands * inverse_a + rounding);
  const VF margin_b = p.per_radian * (two_bands * inverse_b + rounding);
  // Seen from the right, bearings decrease from a to b, except where the segment crosses the rear.
  const VF half = constant(0.5f) * p.turn;
  const VF wide = at_a - at_b;
  const MF wraps = wide < hn::Neg(half);
  const VF low = hn::IfThenElse(wraps, at_b, hn::Min(at_a, at_b));
  const VF high = hn::IfThenElse(wraps, at_a + p.turn, hn::Max(at_a, at_b));
  const VF margin_low = hn::IfThenElse(hn::Or(wraps, at_b <= at_a), margin_b, margin_a);
  const VF margin_high = hn::IfThenElse(hn::Or(wraps, at_b <= at_a), margin_a, margin_b);
  const MF edge_on = hn::Abs(ahead) <= error_margin;
  // If an end is too near for a bearing, or the viewer is on the segment, the segment may cover every beam.
  const VF span = high - low;
  const MF anywhere = hn::Or(hn::Or(hn::Max(margin_a, margin_b) > constant(0.1f) * p.per_radian,
                                    hn::Abs(span - half) < constant(1e-5f) * p.turn),
                             hn::And(edge_on, span > constant(0.1f) * p.per_radian));
  const MF blind = hn::Or(edge_on, anywhere);
  const VF inverse = constant(1.0f) / ahead;
  const VF h = length * inverse;
  const VF a = hn::IfThenZeroElse(blind, hn::Neg(ey) * inverse);
  const VF b = hn::IfThenZeroElse(blind, ex * inverse);
  const VF error = hn::IfThenElse(blind, constant(1e20f), h * (two_bands * h + constant(1.1e-6f)));
  const VF low_possible = hn::IfThenElse(anywhere, constant(-1e30f), low - margin_low);
  const VF high_possible = hn::IfThenElse(anywhere, constant(1e30f), high + margin_high);
  const VF low_certain = hn::IfThenElse(blind, constant(1e30f), low + margin_low);
  const VF high_certain = high - margin_high;
  const auto row = hn::BitCast(kI, hn::LoadU(kU, rows) + hn::Set(kU, first_row));
  append_intervals(out, p, seen, low_possible, high_possible, low_certain, high_certain, a, b, error, row);
  // A segment across the rear also covers beams at the other end of the view.
  const MF wrapped = hn::And(seen, hn::AndNot(anywhere, high_possible + p.slack >= p.turn));
  if (!hn::AllFalse(kF, wrapped))
    append_intervals(out, p, wrapped, low_possible - p.turn, high_possible - p.turn, low_certain - p.turn,
                     high_certain - p.turn, a, b, error, row);
  const MF before = hn::And(seen, hn::AndNot(anywhere, low_possible - p.slack <= constant(p.last - p.full)));
  if (!hn::AllFalse(kF, before))
    append_intervals(out, p, before, low_possible + p.turn, high_possible + p.turn, low_certain + p.turn,
                     high_certain + p.turn, a, b, error, row);
}

/// Sink of projected blocks that rasterizes them.
struct Draw {
  Scratch& s;
  const ScanPattern& pattern;
  HWY_INLINE void operator()(const ProjectedBlock& block) const {
    for (std::uint32_t i = 0; i < block.count; ++i) rasterize(s, pattern, block.parts[i]);
  }
};

}  // namespace sf::raycast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
