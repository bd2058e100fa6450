// Finds the certified nearest segment of each beam, and computes its range in 64 bits. Compiled once per instruction
// set (hwy/foreach_target.h).

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

/// Fills the bit masks of the last beams of all runs with one nearest segment, and of the uncertain beams. @return true
/// if any beam is uncertain
bool find_runs(Scratch& s, std::uint32_t beams) {
  std::fill(s.ends.begin(), s.ends.end(), 0);
  std::fill(s.uncertain.begin(), s.uncertain.end(), 0);
  s.nearest_row[beams] = -2;
  bool any_uncertain = false;
  for (std::uint32_t j = 0; j < beams; j += lanes()) {
    const auto changes = hn::LoadU(kI, &s.nearest_row[j]) != hn::LoadU(kI, &s.nearest_row[j + 1]);
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

/// Calls `range_of(j)` for vectors of beams that start at `j`, and writes the returned ranges and `model` for the beams
/// [first, end). The next run overwrites places after `end`.
template <class Range>
HWY_INLINE void write_run(const ScanPattern& pattern, const ScanOutput& out, std::uint32_t first, std::uint32_t end,
                          std::uint32_t model, Range range_of) {
  const auto step = static_cast<std::uint32_t>(hn::Lanes(kD));
  const auto models = hn::Set(kModels, model);
  std::uint32_t j = first;
  for (; j < end && j + step <= pattern.beams; j += step) {
    hn::StoreU(range_of(j), kD, &out.ranges[j]);
    hn::StoreU(models, kModels, &out.models[j]);
  }
  if (j >= end) return;
  HWY_ALIGN double last[kBlock];
  hn::Store(range_of(j), kD, last);
  std::copy(last, last + (pattern.beams - j), &out.ranges[j]);
  std::fill(&out.models[j], &out.models[pattern.beams], model);
}

/// Computes the ranges of beams [first, end) that meet `g`, with the operations of `intersect`.
HWY_INLINE void write_exact_ranges(const ScanView& view, const ScanPattern& pattern, const ExactSegment& g,
                                   std::uint32_t first, std::uint32_t end, std::uint32_t model, const ScanOutput& out) {
  const double wx = g.ax - view.origin.x, wy = g.ay - view.origin.y;
  const double ex = g.bx - g.ax, ey = g.by - g.ay;
  const VD numerator = hn::Set(kD, ex * wy - ey * wx), dx = hn::Set(kD, ex), dy = hn::Set(kD, ey);
  const VD c = hn::Set(kD, view.heading.x), sn = hn::Set(kD, view.heading.y);
  const VD least = hn::Set(kD, std::max(view.range_min, 0.0));
  const auto range_of = [&](VD x, VD y) HWY_ATTR { return hn::Max(numerator / (dx * y - dy * x), least); };
  if (view.x != nullptr)
    write_run(pattern, out, first, end, model,
              [&](std::uint32_t j) HWY_ATTR { return range_of(hn::LoadU(kD, &view.x[j]), hn::LoadU(kD, &view.y[j])); });
  else
    write_run(pattern, out, first, end, model, [&](std::uint32_t j) HWY_ATTR {
      const VD bc = hn::LoadU(kD, &pattern.cos64[j]), bs = hn::LoadU(kD, &pattern.sin64[j]);
      return range_of(c * bc - sn * bs, c * bs + sn * bc);
    });
}

/// The same ranges in 32 bits, where these are accurate enough.
void measure_in_32_bits(const ScanView& view, const ScanPattern& pattern, const ExactSegment& g, std::uint32_t first,
                        std::uint32_t end, double* ranges) {
  for (std::uint32_t j = first; j < end; ++j) {
    const float t = range_single(g, view.origin, direction_of(view, pattern, j), static_cast<float>(view.range_max));
    if (t >= 0.0f && static_cast<double>(t) < view.range_max)
      ranges[j] = std::max(static_cast<double>(t), view.range_min);
  }
}

/// Calls `visit(first, end, nearest_segment)` for each run of beams [first, end) with one nearest segment.
template <class Visit>
HWY_INLINE void each_run(const Scratch& s, Visit visit) {
  std::uint32_t first = 0;
  for (std::size_t w = 0; w < s.ends.size(); ++w)
    for (std::uint64_t pending = s.ends[w]; pending != 0; pending &= pending - 1) {
      const auto end = static_cast<std::uint32_t>(64 * w) + static_cast<std::uint32_t>(__builtin_ctzll(pending)) + 1;
      visit(first, end, s.nearest_row[first]);
      first = end;
    }
}

bool write_certain_ranges(Scratch& s, const ScanView& view, const ScanPattern& pattern, const ScanScene& scene,
                          const ScanOutput& out) {
  const bool any_uncertain = find_runs(s, pattern.beams);
  each_run(s, [&](std::uint32_t, std::uint32_t, std::int32_t k) {
    if (k >= 0) __builtin_prefetch(&scene.exact[static_cast<std::uint32_t>(k)]);
  });
  const VD none = hn::Set(kD, std::max(view.range_max, view.range_min));
  each_run(s, [&](std::uint32_t first, std::uint32_t end, std::int32_t k) HWY_ATTR {
    if (k < 0) {
      write_run(pattern, out, first, end, SF_NO_HIT, [&](std::uint32_t) HWY_ATTR { return none; });
      return;
    }
    const auto row = static_cast<std::uint32_t>(k);
    write_exact_ranges(view, pattern, scene.exact[row], first, end, scene.models[row], out);
    if (view.single) measure_in_32_bits(view, pattern, scene.exact[row], first, end, out.ranges);
  });
  return any_uncertain;
}

}  // namespace sf::raycast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
