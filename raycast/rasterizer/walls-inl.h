// Rasterizes intervals, and the walls of a cell, near to far.
// Compiled once per instruction set (hwy/foreach_target.h).

#if defined(SF_RAYCAST_WALLS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SF_RAYCAST_WALLS_INL_H
#undef SF_RAYCAST_WALLS_INL_H
#else
#define SF_RAYCAST_WALLS_INL_H
#endif

#include <algorithm>
#include <cmath>

#include "raycast/rasterizer/projection-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sf::raycast::HWY_NAMESPACE {

/// Updates the bounds of the beams that segment `k` may cover.
inline void rasterize(Scratch& s, const ScanPattern& pattern, std::uint32_t k) {
  const VF a = constant(s.a[k]), b = constant(s.b[k]), error = constant(s.error[k]);
  const VF low_possible = constant(s.low_possible[k]), high_possible = constant(s.high_possible[k]);
  const VF low_certain = constant(s.low_certain[k]), high_certain = constant(s.high_certain[k]);
  const auto name = hn::Set(kI, static_cast<std::int32_t>(k));
  const auto step = static_cast<std::int32_t>(lanes());
  const std::int32_t last = s.last[k];
  const float* const places = pattern.place.data();
  const float* const cosines = pattern.cos32.data();
  const float* const sines = pattern.sin32.data();
  float* const nearest_low = s.near_low.data();
  float* const nearest_high = s.near_high.data();
  float* const others = s.others.data();
  std::int32_t* const nearest_segments = s.nearest_segment.data();
  for (std::int32_t j = s.first[k] & ~(step - 1); j <= last; j += step) {
    const VF place = load(places + j);
    const MF possible = hn::And(place >= low_possible, place <= high_possible);
    const MF certain = hn::And(place >= low_certain, place <= high_certain);
    const VF inverse = a * load(cosines + j) + b * load(sines + j);
    const VF high = inverse + error, low = inverse - error;
    const VF near_low = load(nearest_low + j), near_high = load(nearest_high + j);
    const MF nearer = hn::And(certain, low > near_low);
    const VF beaten = hn::IfThenElse(nearer, near_high, hn::IfThenElseZero(possible, high));
    store(hn::Max(load(others + j), beaten), others + j);
    store(hn::IfThenElse(nearer, low, near_low), nearest_low + j);
    store(hn::IfThenElse(nearer, high, near_high), nearest_high + j);
    const auto nearest_segment = hn::LoadU(kI, nearest_segments + j);
    hn::StoreU(hn::IfThenElse(hn::RebindMask(kI, nearer), name, nearest_segment), kI, nearest_segments + j);
  }
}

void rasterize_from(Scratch& s, const ScanPattern& pattern, std::size_t first_live) {
  for (std::size_t q = first_live; q < s.live.size(); ++q) rasterize(s, pattern, s.live[q]);
}

/// False when every beam in [low, high] certainly meets something nearer than `distance`.
bool may_be_visible(const Scratch& s, const ScanPattern& pattern, float low, float high, float distance) {
  const auto last = static_cast<float>(pattern.beams - 1);
  if (high < 0.0f || low > last) return false;
  const auto step = static_cast<std::int32_t>(lanes());
  const auto from = static_cast<std::int32_t>(std::max(std::floor(low), 0.0f)) & ~(step - 1);
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

/// False when the mover is hidden from every beam that its disc covers.
bool may_be_visible(const Scratch& s, const Projection& p, const ScanPattern& pattern, const NearMover& near) {
  return may_be_visible(s, pattern, near.low, near.high, near.distance) ||
         may_be_visible(s, pattern, near.low - p.full, near.high - p.full, near.distance) ||
         may_be_visible(s, pattern, near.low + p.full, near.high + p.full, near.distance);
}

/// True when all segments of a block are out of view or hidden by segments rasterized before.
bool is_occluded(const Scratch& s, const Projection& p, const ScanPattern& pattern, const SegmentBlock& block) {
  if (block.half > 3.0f) return false;
  const float turned = block.bearing - p.yaw;  // within two turns
  const float place = (turned - 6.2831853f * std::rint(turned * 0.15915494f)) * pattern.per_radian + pattern.middle;
  const float wide = (block.half + 4e-6f) * pattern.per_radian + pattern.slack + 0.01f;
  return !may_be_visible(s, p, pattern, {block.nearest, 0, place - wide, place + wide});
}

/// Bit mask of the blocks in the directions of the pattern's beams.
std::uint64_t blocks_in_view(const Projection& p, const ScanPattern& pattern, const SectorBlockMasks& ahead) {
  constexpr float kPerRadian = kSectors / 6.2831853f;
  const float middle = p.yaw * kPerRadian, wide = pattern.half_view * kPerRadian + 1e-3f;
  const auto first = static_cast<int>(std::floor(middle - wide)), last = static_cast<int>(std::floor(middle + wide));
  std::uint64_t pending = 0;
  for (int i = first; i <= std::min(last, first + kSectors - 1); ++i)
    pending |= ahead[static_cast<std::size_t>(i & (kSectors - 1))];
  return pending;
}

void rasterize_walls(Scratch& s, const Projection& p, const ScanView& view, const ScanPattern& pattern,
                     const ScanScene& scene) {
  const VF ox = constant(static_cast<float>(view.offset.x)), oy = constant(static_cast<float>(view.offset.y));
  const std::span<const SegmentBlock> walls = scene.walls.first(scene.front_facing);
  const auto rasterize_block = [&](const SegmentBlock& block) {
    if (is_occluded(s, p, pattern, block)) return;
    const std::size_t first_live = s.live.size();
    for (std::uint32_t k = 0; k < kBlock; k += lanes())
      project(s, p, load(block.ax + k) - ox, load(block.ay + k) - oy, load(block.ex + k), load(block.ey + k),
              block.row + k, 0);
    rasterize_from(s, pattern, first_live);
  };
  if (scene.block_masks != nullptr) {
    const std::uint64_t front_facing = walls.size() < 64 ? (std::uint64_t{1} << walls.size()) - 1 : ~std::uint64_t{0};
    for (std::uint64_t pending = front_facing & blocks_in_view(p, pattern, *scene.block_masks); pending != 0;
         pending &= pending - 1) {
      if ((pending & (pending - 1)) != 0)
        __builtin_prefetch(&walls[static_cast<std::size_t>(__builtin_ctzll(pending & (pending - 1)))]);
      rasterize_block(walls[static_cast<std::size_t>(__builtin_ctzll(pending))]);
    }
    return;
  }
  for (std::size_t i = 0; i < walls.size(); ++i) {
    __builtin_prefetch(&walls[std::min(i + 3, walls.size() - 1)]);
    rasterize_block(walls[i]);
  }
}

}  // namespace sf::raycast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
