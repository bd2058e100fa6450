// Intervals of beams: the nearest segments in an interval, and whether an interval is hidden. Compiled once per
// instruction set (hwy/foreach_target.h).

#if defined(SF_RAYCAST_INTERVALS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SF_RAYCAST_INTERVALS_INL_H
#undef SF_RAYCAST_INTERVALS_INL_H
#else
#define SF_RAYCAST_INTERVALS_INL_H
#endif

#include <algorithm>
#include <cmath>

#include "raycast/rasterizer/vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sf::raycast::HWY_NAMESPACE {

/// A vector of segments, projected to the beams that they cover.
struct Intervals {
  HWY_ALIGN float a[kBlock], b[kBlock], error[kBlock];  ///< 1 / t = a cos + b sin, within error [1/m]
  HWY_ALIGN float low_possible[kBlock], high_possible[kBlock], low_certain[kBlock],
      high_certain[kBlock];                     ///< places of beams that each segment may cover, and certainly covers
  HWY_ALIGN float first[kBlock], last[kBlock];  ///< indices of beams to test; last < first: none
  HWY_ALIGN std::int32_t row[kBlock];           ///< of the exact segment
  std::uint32_t from, end;                      ///< beams to test for all segments
};

/// Updates the bounds of all beams that `g` may cover. The bounds of a vector of beams stay in registers while all
/// segments are compared with them.
inline void rasterize(Scratch& s, const ScanPattern& pattern, const Intervals& g) {
  const std::uint32_t step = lanes();
  const VF first = hn::Load(kF, g.first), last = hn::Load(kF, g.last);
  for (std::uint32_t j = g.from & ~(step - 1); j <= g.end; j += step) {
    const VF begin = constant(static_cast<float>(j)), end = constant(static_cast<float>(j + step - 1));
    std::uint32_t pending = bits_of(hn::And(first <= end, last >= begin));
    if (pending == 0) continue;
    const VF place = load(&pattern.place[j]), cosine = load(&pattern.cos32[j]), sine = load(&pattern.sin32[j]);
    VF near_low = load(&s.near_low[j]), near_high = load(&s.near_high[j]), others = load(&s.others[j]);
    auto nearest_row = hn::LoadU(kI, &s.nearest_row[j]);
    for (; pending != 0; pending &= pending - 1) {
      const auto k = static_cast<std::uint32_t>(__builtin_ctz(pending));
      const MF possible = hn::And(place >= constant(g.low_possible[k]), place <= constant(g.high_possible[k]));
      const MF certain = hn::And(place >= constant(g.low_certain[k]), place <= constant(g.high_certain[k]));
      const VF inverse = constant(g.a[k]) * cosine + constant(g.b[k]) * sine, error = constant(g.error[k]);
      const VF high = inverse + error, low = hn::IfThenElseZero(certain, inverse - error);
      const MF nearer = low > near_low;
      others = hn::Max(others, hn::IfThenElse(nearer, near_high, hn::IfThenElseZero(possible, high)));
      near_low = hn::Max(near_low, low);
      near_high = hn::IfThenElse(nearer, high, near_high);
      nearest_row = hn::IfThenElse(hn::RebindMask(kI, nearer), hn::Set(kI, g.row[k]), nearest_row);
    }
    store(near_low, &s.near_low[j]), store(near_high, &s.near_high[j]), store(others, &s.others[j]);
    hn::StoreU(nearest_row, kI, &s.nearest_row[j]);
  }
}

/// Returns false if every beam in [low, high] certainly meets a surface nearer than `distance`.
HWY_INLINE bool may_be_visible(const Scratch& s, const ScanPattern& pattern, float low, float high, float distance) {
  const auto last = static_cast<float>(pattern.beams - 1);
  if (high < 0.0f || low > last) return false;
  const auto step = static_cast<std::int32_t>(lanes());
  const auto from = static_cast<std::int32_t>(std::max(low, 0.0f)) & ~(step - 1);
  const auto to = static_cast<std::int32_t>(std::min(std::ceil(high), last));
  const VF inverse = constant(distance > 1e-6f ? 1.0001f / distance : 1e30f);
  const VF first = constant(low), end = constant(high);
  for (std::int32_t j = from; j <= to; j += step) {
    const VF place = load(&pattern.place[j]);
    const MF touched = hn::And(place >= first, place <= end);
    if (!hn::AllFalse(kF, hn::And(touched, load(&s.near_low[j]) < inverse))) return true;
  }
  return false;
}

/// The same, also for beams that are a full turn away.
inline bool may_be_visible(const Scratch& s, const ScanPattern& pattern, float turn, float low, float high,
                           float distance) {
  return may_be_visible(s, pattern, low, high, distance) ||
         may_be_visible(s, pattern, low - turn, high - turn, distance) ||
         may_be_visible(s, pattern, low + turn, high + turn, distance);
}

/// Returns a distance [m] within which every beam certainly meets a surface.
inline float horizon_of(const Scratch& s, const ScanPattern& pattern) {
  VF least = load(&s.near_low[0]);
  for (std::uint32_t j = 0; j < pattern.beams; j += lanes()) least = hn::Min(least, load(&s.near_low[j]));
  return 1.0001f / hn::GetLane(hn::MinOfLanes(kF, least));
}

}  // namespace sf::raycast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
