// The certified nearest segment of each beam, and its range in 64 bits.
// Compiled once per instruction set (hwy/foreach_target.h).

#if defined(SF_RAYCAST_RANGES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SF_RAYCAST_RANGES_INL_H
#undef SF_RAYCAST_RANGES_INL_H
#else
#define SF_RAYCAST_RANGES_INL_H
#endif

#include <algorithm>

#include "raycast/rasterizer/vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sf::raycast::HWY_NAMESPACE {

/// Fills the bit masks of the last beam of each run of one nearest segment, and of the uncertain beams.
/// @return true when any beam is uncertain
bool find_runs(Scratch& s, std::uint32_t beams) {
  std::fill(s.ends.begin(), s.ends.end(), 0);
  std::fill(s.uncertain.begin(), s.uncertain.end(), 0);
  s.nearest_segment[beams] = -2;
  bool any_uncertain = false;
  for (std::uint32_t j = 0; j < beams; j += lanes()) {
    const auto changes = hn::LoadU(kI, &s.nearest_segment[j]) != hn::LoadU(kI, &s.nearest_segment[j + 1]);
    s.ends[j >> 6] |= std::uint64_t{bits_of(hn::RebindMask(kF, changes))} << (j & 63);
    const std::uint32_t uncertain = bits_of(load(&s.near_low[j]) <= load(&s.others[j]));
    s.uncertain[j >> 6] |= std::uint64_t{uncertain} << (j & 63);
    any_uncertain = any_uncertain || uncertain != 0;
  }
  if (beams % 64 != 0) {
    const std::uint64_t inside = (std::uint64_t{1} << (beams % 64)) - 1;
    s.ends[beams / 64] &= inside;
    s.uncertain[beams / 64] &= inside;
  }
  return any_uncertain;
}

/// Ranges of beams [first, end) that meet `g`, by the operations of `intersect`.
inline void exact_ranges(const ScanView& view, const ScanPattern& pattern, const ExactSegment& g, std::uint32_t first,
                         std::uint32_t end, double* ranges) {
  const double wx = g.ax - view.origin.x, wy = g.ay - view.origin.y;
  const double ex = g.bx - g.ax, ey = g.by - g.ay;
  const VD numerator = hn::Set(kD, ex * wy - ey * wx), dx = hn::Set(kD, ex), dy = hn::Set(kD, ey);
  const VD c = hn::Set(kD, view.heading.x), sn = hn::Set(kD, view.heading.y);
  const VD least = hn::Set(kD, std::max(view.range_min, 0.0));
  const auto step = static_cast<std::uint32_t>(hn::Lanes(kD));
  for (std::uint32_t j = first; j < end; j += step) {
    VD x, y;
    if (view.x != nullptr) {
      x = hn::LoadU(kD, &view.x[j]), y = hn::LoadU(kD, &view.y[j]);
    } else {
      const VD bc = hn::LoadU(kD, &pattern.cos64[j]), bs = hn::LoadU(kD, &pattern.sin64[j]);
      x = c * bc - sn * bs, y = c * bs + sn * bc;
    }
    const VD range = hn::Max(numerator / (dx * y - dy * x), least);
    if (j + step <= pattern.beams) {
      hn::StoreU(range, kD, &ranges[j]);  // the next run overwrites places behind `end`
    } else {
      HWY_ALIGN double last[kBlock];
      hn::Store(range, kD, last);
      std::copy(last, last + (pattern.beams - j), &ranges[j]);
    }
  }
}

/// The same ranges in 32 bits, where these are accurate enough.
void measure_in_32_bits(const ScanView& view, const ScanPattern& pattern, const ExactSegment& g, std::uint32_t first,
                        std::uint32_t end, double* ranges) {
  for (std::uint32_t j = first; j < end; ++j) {
    const float t = range_single(g, view.origin, direction_of(view, pattern, j), static_cast<float>(view.range_max));
    if (t >= 0.0f) ranges[j] = std::max(std::min(static_cast<double>(t), view.range_max), view.range_min);
  }
}

/// Calls `visit(first, end, nearest_segment)` for each run of beams [first, end) with one nearest segment.
template <class Visit>
HWY_INLINE void each_run(const Scratch& s, Visit visit) {
  std::uint32_t first = 0;
  for (std::size_t w = 0; w < s.ends.size(); ++w)
    for (std::uint64_t pending = s.ends[w]; pending != 0; pending &= pending - 1) {
      const auto end = static_cast<std::uint32_t>(64 * w) + static_cast<std::uint32_t>(__builtin_ctzll(pending)) + 1;
      visit(first, end, s.nearest_segment[first]);
      first = end;
    }
}

bool write_certain_ranges(Scratch& s, const ScanView& view, const ScanPattern& pattern, const ScanScene& scene,
                          const ScanOutput& out) {
  const bool any_uncertain = find_runs(s, pattern.beams);
  each_run(s, [&](std::uint32_t, std::uint32_t, std::int32_t k) {
    if (k >= 0) __builtin_prefetch(&scene.exact[s.row[static_cast<std::uint32_t>(k)]]);
  });
  each_run(s, [&](std::uint32_t first, std::uint32_t end, std::int32_t k) {
    const std::uint32_t row = k < 0 ? SF_NO_HIT : s.row[static_cast<std::uint32_t>(k)];
    if (k < 0)
      std::fill(&out.ranges[first], &out.ranges[end], std::max(view.range_max, view.range_min));
    else
      exact_ranges(view, pattern, scene.exact[row], first, end, out.ranges);
    if (k >= 0 && view.single) measure_in_32_bits(view, pattern, scene.exact[row], first, end, out.ranges);
    std::fill(&out.models[first], &out.models[end], k < 0 ? SF_NO_HIT : scene.models[row]);
  });
  return any_uncertain;
}

}  // namespace sf::raycast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
