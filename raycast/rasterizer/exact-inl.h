// 64-bit intersection of one beam with all segments that it may cross.
// Compiled once per instruction set (hwy/foreach_target.h).

#if defined(SF_RAYCAST_EXACT_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SF_RAYCAST_EXACT_INL_H
#undef SF_RAYCAST_EXACT_INL_H
#else
#define SF_RAYCAST_EXACT_INL_H
#endif

#include <algorithm>
#include <cmath>

#include "raycast/bearing_index.h"
#include "raycast/rasterizer/movers-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sf::raycast::HWY_NAMESPACE {

/// Bit mask of the segments of a block that direction `d` may cross, including segments behind the viewer. Start and
/// extent are rotated by `heading` and translated by `from`.
inline std::uint32_t segments_crossing(const SegmentBlock& block, glm::dvec2 from, glm::dvec2 heading, glm::dvec2 d,
                                       float band) {
  const VF c = constant(static_cast<float>(heading.x)), sn = constant(static_cast<float>(heading.y));
  const VF x = constant(static_cast<float>(from.x)), y = constant(static_cast<float>(from.y));
  const VF dx = constant(static_cast<float>(d.x)), dy = constant(static_cast<float>(d.y)),
           tolerance = constant(2.0f * band);
  std::uint32_t found = 0;
  for (std::uint32_t k = 0; k < kBlock; k += lanes()) {
    const VF ax = load(block.ax + k), ay = load(block.ay + k), ex = load(block.ex + k), ey = load(block.ey + k);
    const VF wx = x + (c * ax - sn * ay), wy = y + (sn * ax + c * ay), gx = c * ex - sn * ey, gy = sn * ex + c * ey;
    const VF start = dx * wy - dy * wx, end = start + (dx * gy - dy * gx);
    const MF apart = hn::Or(hn::Min(start, end) > tolerance, hn::Max(start, end) < hn::Neg(tolerance));
    found |= bits_of(hn::Not(apart)) << k;
  }
  return found;
}

/// Intersects beam `d` with the segments of a block that it may cross.
void intersect_block(Scratch& s, const ScanView& view, const ScanScene& scene, const SegmentBlock& block,
                     glm::dvec2 from, glm::dvec2 heading, std::uint32_t first_row, glm::dvec2 d, ClosestHit& best) {
  for (std::uint32_t pending = segments_crossing(block, from, heading, d, view.band); pending != 0;
       pending &= pending - 1) {
    const std::uint32_t number = block.row[__builtin_ctz(pending)];
    if (number == SF_NO_HIT) continue;
    ++s.counts.decisions;
    intersect({scene.exact[first_row + number], first_row + number}, view.origin, d, best);
  }
}

void intersect_cell(Scratch& s, const ScanView& view, const ScanScene& scene, const CellBlocks& cell, glm::dvec2 d,
                    ClosestHit& best) {
  VF unused;
  const VF bearing = bearing_of(constant(static_cast<float>(d.y)), constant(static_cast<float>(d.x)), unused);
  for (std::size_t first = 0; first < cell.blocks.size(); first += lanes()) {
    VF nearest, middle, half;
    hn::LoadInterleaved3(kF, &cell.bounds[first].nearest, nearest, middle, half);
    const VF turned = hn::Abs(middle - bearing), apart = hn::Min(turned, hn::Abs(constant(6.2831853f) - turned));
    const VF farthest = constant(static_cast<float>(best.range) * 1.00001f);
    std::uint32_t pending = bits_of(hn::And(apart <= half + constant(1e-5f), nearest <= farthest));
    if (cell.blocks.size() - first < lanes()) pending &= (1u << (cell.blocks.size() - first)) - 1;
    for (; pending != 0; pending &= pending - 1) {
      const std::size_t i = first + static_cast<std::size_t>(__builtin_ctz(pending));
      if (static_cast<double>(cell.bounds[i].nearest) > best.range) continue;
      intersect_block(s, view, scene, cell.blocks[i], -1.0 * cell.offset, {1.0, 0.0}, 0, d, best);
    }
  }
}

void intersect_crowd(Scratch& s, const ScanView& view, const ScanScene& scene, glm::dvec2 d, ClosestHit& best) {
  if (scene.crowd_index != nullptr)
    s.counts.decisions +=
        scene.crowd_index->intersect(scene.crowd.offset, view.origin, d, {scene.own_first, scene.own_end}, best);
  else
    intersect_cell(s, view, scene, scene.crowd, d, best);
}

/// Initializes each beam with its nearest segment of the crowd, from the crowd's index. Beams that graze that segment
/// or start on it are left to `intersect_uncertain_beams`.
void draw_indexed_crowd(Scratch& s, const ScanView& view, const ScanPattern& pattern, const ScanScene& scene) {
  constexpr float kMinSine = 2e-3f;
  constexpr double kNearest = 1e-6;  // [m]
  for (std::size_t i = 0; i < pattern.beams; ++i) {
    ClosestHit best{view.range_max};
    intersect_crowd(s, view, scene, direction_of(view, pattern, i), best);
    if (best.id == SF_NO_HIT) continue;
    const auto inverse = static_cast<float>(1.0 / std::max(best.range, kNearest));
    s.near_low[i] = inverse * (1.0f - 1e-6f), s.near_high[i] = inverse * (1.0f + 1e-6f);
    s.nearest_row[i] = static_cast<std::int32_t>(best.id);
    if (best.grazes(kMinSine) || best.range <= kNearest) s.others[i] = HUGE_VALF;
  }
  const std::size_t last = pattern.beams - 1;
  for (std::size_t i = last + 1; i <= last + lanes(); ++i) s.near_low[i] = s.near_low[last];
}

/// Lists the movers in grid entries [from, end) whose discs beam `d` may cross within `range`.
void find_movers_on_beam(Scratch& s, const ScanView& view, const ScanScene& scene, glm::dvec2 d, double range,
                         std::uint32_t from, std::uint32_t end) {
  const MoverGrid& grid = *scene.movers;
  const VF x = constant(static_cast<float>(view.origin.x - grid.low.x));
  const VF y = constant(static_cast<float>(view.origin.y - grid.low.y));
  const VF ux = constant(static_cast<float>(d.x)), uy = constant(static_cast<float>(d.y));
  const VF reach = constant(static_cast<float>(range) * 1.00001f), tolerance = constant(grid.error + view.band);
  for (std::uint32_t at = from; at < end; at += lanes()) {
    const VF dx = load(&grid.x[at]) - x, dy = load(&grid.y[at]) - y;
    const VF radius = load(&grid.radius[at]) * constant(1.0001f) + tolerance;
    const VF along = dx * ux + dy * uy, aside = hn::Abs(dx * uy - dy * ux);
    const MF across = hn::And(hn::And(aside <= radius, along >= hn::Neg(radius)), along - radius <= reach);
    std::uint32_t pending = bits_of(across);
    if (end - at < lanes()) pending &= (1u << (end - at)) - 1;
    for (; pending != 0; pending &= pending - 1) {
      const std::uint32_t i = at + static_cast<std::uint32_t>(__builtin_ctz(pending));
      if (!grid.skips(i, scene.self) && !scene.in_crowd(grid.mover[i])) s.across.push_back(grid.mover[i]);
    }
  }
}

void intersect_mover(Scratch& s, const ScanView& view, const ScanScene& scene, std::uint32_t mover, glm::dvec2 d,
                     ClosestHit& best) {
  const OutlineTable::Outline& outline = scene.outline_of(mover);
  const base::Pose& X = scene.states[mover].X_WM;
  const glm::dvec2 place = glm::dvec2{X.x, X.y} - view.origin;
  for (std::uint32_t i = outline.first; i < outline.first + outline.outward; ++i)
    intersect_block(s, view, scene, scene.outlines->blocks[i], place, scene.headings[mover], scene.first_rows[mover], d,
                    best);
}

/// Intersects the movers along the beam, using the grid.
void intersect_movers(Scratch& s, const ScanView& view, const ScanScene& scene, glm::dvec2 d, ClosestHit& best) {
  const MoverGrid& grid = *scene.movers;
  const double margin = grid.largest_radius * 1.001 + 2.0 * static_cast<double>(grid.error);
  const glm::dvec2 from{view.origin.x - grid.low.x, view.origin.y - grid.low.y}, to = from + best.range * d;
  const int x0 = grid.column_of(std::min(from.x, to.x) - margin), x1 = grid.column_of(std::max(from.x, to.x) + margin);
  const std::uint32_t copy = grid.copies.copy_of(scene.self);
  const int y0 = grid.row_of(std::min(from.y, to.y) - margin, copy);
  const int y1 = grid.row_of(std::max(from.y, to.y) + margin, copy);
  s.across.clear();
  for (int row = y0; row <= y1; ++row)
    find_movers_on_beam(s, view, scene, d, best.range, grid.begin_of(x0, row), grid.begin_of(x1 + 1, row));
  for (const std::uint32_t mover : s.across) intersect_mover(s, view, scene, mover, d, best);
}

/// Intersects the movers that the scan found near the beam at `place`, near to far.
void intersect_near_movers(Scratch& s, const ScanView& view, const ScanPattern& pattern, const ScanScene& scene,
                           float place, glm::dvec2 d, ClosestHit& best) {
  const float turn = 6.2831853f * pattern.per_radian;
  for (const std::uint64_t key : s.order) {
    const NearMover& near = s.near[key & 0xFFFFFFFFu];
    if (static_cast<double>(near.distance) > best.range * 1.0001) break;
    const auto covers = [&](float at) { return at >= near.low && at <= near.high; };
    if (covers(place) || covers(place - turn) || covers(place + turn))
      intersect_mover(s, view, scene, near.mover, d, best);
  }
}

/// Writes the result of a beam. @return true if it grazes a surface
bool write_beam(const ScanView& view, const ScanScene& scene, std::size_t i, glm::dvec2 d, ClosestHit best,
                const ScanOutput& out) {
  const bool grazes = best.grazes(static_cast<float>(view.min_sine));
  if (best.range >= view.range_max) best.id = SF_NO_HIT;
  if (view.single && best.id != SF_NO_HIT) {
    const float t = range_single(scene.exact[best.id], view.origin, d, static_cast<float>(view.range_max));
    if (t >= 0.0f && static_cast<double>(t) < view.range_max) best.range = static_cast<double>(t);
  }
  out.ranges[i] = std::max(best.range, view.range_min);
  out.models[i] = best.id == SF_NO_HIT ? SF_NO_HIT : scene.models[best.id];
  out.grazes[i] = grazes ? 1 : 0;
  return grazes;
}

/// Intersects every beam in 64 bits. @return true if any grazes a surface
bool intersect_all_beams(Scratch& s, const ScanView& view, const ScanPattern& pattern, const ScanScene& scene,
                         const ScanOutput& out) {
  bool grazes = false;
  for (std::size_t i = 0; i < pattern.beams; ++i) {
    const glm::dvec2 d = direction_of(view, pattern, i);
    ClosestHit best{view.range_max};
    intersect_crowd(s, view, scene, d, best);
    intersect_cell(s, view, scene, scene.walls, d, best);
    if (scene.movers != nullptr) intersect_movers(s, view, scene, d, best);
    grazes |= write_beam(view, scene, i, d, best, out);
  }
  return grazes;
}

}  // namespace sf::raycast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
