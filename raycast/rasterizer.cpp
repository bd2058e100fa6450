#include "raycast/rasterizer.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "raycast/rasterizer_scratch.h"

#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raycast/rasterizer.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sf::raycast::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Scratch = Rasterizer::Scratch;

constexpr hn::CappedTag<float, kBlock> kF;
using F = decltype(kF);
using VF = hn::Vec<F>;
using MF = hn::Mask<F>;
constexpr hn::RebindToSigned<F> kI;
constexpr hn::RebindToUnsigned<F> kU;
constexpr hn::ScalableTag<double> kD;
using VD = hn::Vec<decltype(kD)>;

inline std::uint32_t lanes() { return static_cast<std::uint32_t>(hn::Lanes(kF)); }
inline VF constant(float value) { return hn::Set(kF, value); }
inline VF load(const float* p) { return hn::LoadU(kF, p); }
inline void store(VF v, float* p) { hn::StoreU(v, kF, p); }

inline std::uint32_t bits_of(MF mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(kF, mask, bytes);
  return static_cast<std::uint32_t>(bytes[0]) | static_cast<std::uint32_t>(bytes[1]) << 8;
}

/// [rad] of (x, y), to 1e-6, and the inverse of the larger of |x| and |y|. Abramowitz and Stegun 4.4.49.
inline VF bearing_of(VF y, VF x, VF& inverse) {
  const VF across = hn::Abs(y), along = hn::Abs(x);
  const VF larger = hn::Max(hn::Max(along, across), constant(1e-30f));
  inverse = constant(1.0f) / larger;
  const VF q = hn::Min(along, across) * inverse;
  const VF z = q * q;
  VF p = constant(0.0028662257f) * z - constant(0.0161657367f);
  for (const float c :
       {0.0429096138f, -0.0752896400f, 0.1065626393f, -0.1420889944f, 0.1999355085f, -0.3333314528f, 1.0f})
    p = p * z + constant(c);
  p = p * q;
  p = hn::IfThenElse(across > along, constant(1.57079637f) - p, p);
  p = hn::IfThenElse(x < constant(0.0f), constant(3.14159274f) - p, p);
  return hn::CopySignToAbs(p, y);
}

/// The values that all segments of one scan are projected with.
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
          static_cast<float>(std::remainder(view.yaw, 2.0 * M_PI)),
          pattern.narrow,
          constant(pattern.edge_cos),
          constant(pattern.edge_sin)};
}

/// Puts the intervals of `mask` that touch beams at the scratch's end.
inline void keep(Scratch& s, const Projection& p, MF mask, VF low_any, VF high_any, VF low_sure, VF high_sure, VF a,
                 VF b, VF error, const std::uint32_t* rows, std::uint32_t first_row) {
  const VF first = hn::Max(hn::Floor(low_any - p.slack), constant(0.0f));
  const VF last = hn::Min(hn::Ceil(high_any + p.slack), constant(p.last));
  std::uint32_t open = bits_of(hn::And(mask, first <= last));
  if (open == 0) return;
  const std::uint32_t at = s.used;
  store(a, &s.a[at]), store(b, &s.b[at]), store(error, &s.error[at]);
  store(low_any, &s.low_any[at]), store(high_any, &s.high_any[at]);
  store(low_sure, &s.low_sure[at]), store(high_sure, &s.high_sure[at]);
  // Beyond 2^31 there is no beam.
  hn::StoreU(hn::ConvertTo(kI, hn::Min(first, constant(1e9f))), kI, &s.first[at]);
  hn::StoreU(hn::ConvertTo(kI, hn::Max(last, constant(-1.0f))), kI, &s.last[at]);
  hn::StoreU(hn::LoadU(kU, rows) + hn::Set(kU, first_row), kU, &s.row[at]);
  for (; open != 0; open &= open - 1) s.live.push_back(at + static_cast<std::uint32_t>(__builtin_ctz(open)));
  s.used += lanes();
}

/// Projects segments that start at (wx, wy) from the viewer and extend by (gx, gy), in the world's directions.
inline void project(Scratch& s, const Projection& p, VF wx, VF wy, VF gx, VF gy, const std::uint32_t* rows,
                    std::uint32_t first_row) {
  const VF length = hn::Abs(gx) + hn::Abs(gy);
  const VF unsure = p.band * length;
  const VF ahead = gx * wy - gy * wx;
  MF seen = ahead > hn::Neg(unsure);
  const VF ax = p.heading_cos * wx + p.heading_sin * wy, ay = p.heading_cos * wy - p.heading_sin * wx;
  const VF ex = p.heading_cos * gx + p.heading_sin * gy, ey = p.heading_cos * gy - p.heading_sin * gx;
  const VF bx = ax + ex, by = ay + ey;
  if (p.narrow) {
    // Both ends beyond the left edge of the view, or both beyond the right one.
    const VF slip = constant(-8.0f) * p.band;
    const VF left_a = p.edge_sin * ax - p.edge_cos * ay, left_b = p.edge_sin * bx - p.edge_cos * by;
    const VF right_a = p.edge_sin * ax + p.edge_cos * ay, right_b = p.edge_sin * bx + p.edge_cos * by;
    seen = hn::And(seen, hn::And(hn::Max(left_a, left_b) >= slip, hn::Max(right_a, right_b) >= slip));
  }
  if (hn::AllFalse(kF, seen)) return;
  VF inverse_a, inverse_b;
  const VF at_a = bearing_of(ay, ax, inverse_a) * p.per_radian + p.middle;
  const VF at_b = bearing_of(by, bx, inverse_b) * p.per_radian + p.middle;
  const VF two_bands = p.band + p.band;
  const VF rounding = constant(2e-6f);
  const VF margin_a = p.per_radian * (two_bands * inverse_a + rounding);
  const VF margin_b = p.per_radian * (two_bands * inverse_b + rounding);
  // Seen from the right, bearings fall from a to b, unless the rear is crossed between them.
  const VF half = constant(0.5f) * p.turn;
  const VF wide = at_a - at_b;
  const MF wraps = wide < hn::Neg(half);
  const VF low = hn::IfThenElse(wraps, at_b, hn::Min(at_a, at_b));
  const VF high = hn::IfThenElse(wraps, at_a + p.turn, hn::Max(at_a, at_b));
  const VF margin_low = hn::IfThenElse(hn::Or(wraps, at_b <= at_a), margin_b, margin_a);
  const VF margin_high = hn::IfThenElse(hn::Or(wraps, at_b <= at_a), margin_a, margin_b);
  const MF edge_on = hn::Abs(ahead) <= unsure;
  // An end too near to have a bearing, or a viewer between the ends of a segment that it stands on: anywhere.
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
  const VF low_any = hn::IfThenElse(anywhere, constant(-1e30f), low - margin_low);
  const VF high_any = hn::IfThenElse(anywhere, constant(1e30f), high + margin_high);
  const VF low_sure = hn::IfThenElse(blind, constant(1e30f), low + margin_low);
  const VF high_sure = high - margin_high;
  s.reserve(3 * lanes());
  keep(s, p, seen, low_any, high_any, low_sure, high_sure, a, b, error, rows, first_row);
  // A segment across the rear is met at the other end of the view too.
  const MF again = hn::And(seen, hn::AndNot(anywhere, high_any + p.slack >= p.turn));
  if (!hn::AllFalse(kF, again))
    keep(s, p, again, low_any - p.turn, high_any - p.turn, low_sure - p.turn, high_sure - p.turn, a, b, error, rows,
         first_row);
  const MF before = hn::And(seen, hn::AndNot(anywhere, low_any - p.slack <= constant(p.last - p.full)));
  if (!hn::AllFalse(kF, before))
    keep(s, p, before, low_any + p.turn, high_any + p.turn, low_sure + p.turn, high_sure + p.turn, a, b, error, rows,
         first_row);
}

/// Enters segment `k` into the beams that it may cover.
inline void draw(Scratch& s, const ScanPattern& pattern, std::uint32_t k) {
  const VF a = constant(s.a[k]), b = constant(s.b[k]), error = constant(s.error[k]);
  const VF low_any = constant(s.low_any[k]), high_any = constant(s.high_any[k]);
  const VF low_sure = constant(s.low_sure[k]), high_sure = constant(s.high_sure[k]);
  const auto name = hn::Set(kI, static_cast<std::int32_t>(k));
  const auto step = static_cast<std::int32_t>(lanes());
  const std::int32_t last = s.last[k];
  const float* const places = pattern.place.data();
  const float* const cosines = pattern.cos32.data();
  const float* const sines = pattern.sin32.data();
  float* const nearest_low = s.near_low.data();
  float* const nearest_high = s.near_high.data();
  float* const others = s.others.data();
  std::int32_t* const winners = s.winner.data();
  for (std::int32_t j = s.first[k] & ~(step - 1); j <= last; j += step) {
    const VF place = load(places + j);
    const MF any = hn::And(place >= low_any, place <= high_any);
    const MF sure = hn::And(place >= low_sure, place <= high_sure);
    const VF inverse = a * load(cosines + j) + b * load(sines + j);
    const VF high = inverse + error, low = inverse - error;
    const VF near_low = load(nearest_low + j), near_high = load(nearest_high + j);
    const MF nearer = hn::And(sure, low > near_low);
    const VF beaten = hn::IfThenElse(nearer, near_high, hn::IfThenElseZero(any, high));
    store(hn::Max(load(others + j), beaten), others + j);
    store(hn::IfThenElse(nearer, low, near_low), nearest_low + j);
    store(hn::IfThenElse(nearer, high, near_high), nearest_high + j);
    const auto winner = hn::LoadU(kI, winners + j);
    hn::StoreU(hn::IfThenElse(hn::RebindMask(kI, nearer), name, winner), kI, winners + j);
  }
}

void draw_from(Scratch& s, const ScanPattern& pattern, std::size_t first_live) {
  for (std::size_t q = first_live; q < s.live.size(); ++q) draw(s, pattern, s.live[q]);
}

/// Whether some beam of [low, high] may see something nearer than `distance`.
bool is_open(const Scratch& s, const ScanPattern& pattern, float low, float high, float distance) {
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

/// Whether some beam that the mover's disc touches may see it.
bool is_open(const Scratch& s, const Projection& p, const ScanPattern& pattern, const NearMover& near) {
  return is_open(s, pattern, near.low, near.high, near.distance) ||
         is_open(s, pattern, near.low - p.full, near.high - p.full, near.distance) ||
         is_open(s, pattern, near.low + p.full, near.high + p.full, near.distance);
}

/// Whether all of a block's segments are out of view or behind what is drawn.
bool is_hidden(const Scratch& s, const Projection& p, const ScanPattern& pattern, const SegmentBlock& block) {
  if (block.half > 3.0f) return false;
  const float turned = block.bearing - p.yaw;  // within two turns
  const float place = (turned - 6.2831853f * std::rint(turned * 0.15915494f)) * pattern.per_radian + pattern.middle;
  const float wide = (block.half + 4e-6f) * pattern.per_radian + pattern.slack + 0.01f;
  return !is_open(s, p, pattern, {block.nearest, 0, place - wide, place + wide});
}

/// Blocks that some beam may look at, a bit each.
std::uint64_t blocks_ahead(const Projection& p, const ScanPattern& pattern, const BlocksAhead& ahead) {
  constexpr float kPerRadian = kSectors / 6.2831853f;
  const float middle = p.yaw * kPerRadian, wide = pattern.half_view * kPerRadian + 1e-3f;
  const auto first = static_cast<int>(std::floor(middle - wide)), last = static_cast<int>(std::floor(middle + wide));
  std::uint64_t open = 0;
  for (int i = first; i <= std::min(last, first + kSectors - 1); ++i)
    open |= ahead[static_cast<std::size_t>(i & (kSectors - 1))];
  return open;
}

void draw_walls(Scratch& s, const Projection& p, const ScanView& view, const ScanPattern& pattern,
                const ScanScene& scene) {
  const VF ox = constant(static_cast<float>(view.offset.x)), oy = constant(static_cast<float>(view.offset.y));
  const std::span<const SegmentBlock> walls = scene.walls;
  const auto draw_block = [&](const SegmentBlock& block) {
    if (is_hidden(s, p, pattern, block)) return;
    const std::size_t first_live = s.live.size();
    for (std::uint32_t k = 0; k < kBlock; k += lanes())
      project(s, p, load(block.ax + k) - ox, load(block.ay + k) - oy, load(block.ex + k), load(block.ey + k),
              block.row + k, 0);
    draw_from(s, pattern, first_live);
  };
  if (scene.ahead != nullptr) {
    for (std::uint64_t open = blocks_ahead(p, pattern, *scene.ahead); open != 0; open &= open - 1) {
      if ((open & (open - 1)) != 0)
        __builtin_prefetch(&walls[static_cast<std::size_t>(__builtin_ctzll(open & (open - 1)))]);
      draw_block(walls[static_cast<std::size_t>(__builtin_ctzll(open))]);
    }
    return;
  }
  for (std::size_t i = 0; i < walls.size(); ++i) {
    __builtin_prefetch(&walls[std::min(i + 3, walls.size() - 1)]);
    draw_block(walls[i]);
  }
}

/// Lists the movers of one row of cells that are in reach, in view and not behind walls.
void find_near(Scratch& s, const Projection& p, const ScanView& view, const ScanPattern& pattern,
               const ScanScene& scene, std::uint32_t from, std::uint32_t end) {
  const MoverGrid& grid = *scene.movers;
  const VF x = constant(static_cast<float>(view.origin.x - grid.low.x)),
           y = constant(static_cast<float>(view.origin.y - grid.low.y));
  const VF reach = constant(static_cast<float>(view.range_max) * 1.00001f), slip = constant(grid.error) + p.band;
  for (std::uint32_t at = from; at < end; at += lanes()) {
    const VF dx = load(&grid.x[at]) - x, dy = load(&grid.y[at]) - y;
    const VF radius = load(&grid.radius[at]) * constant(1.0001f) + slip;
    const VF ahead = p.heading_cos * dx + p.heading_sin * dy, left = p.heading_cos * dy - p.heading_sin * dx;
    const VF distance = hn::Sqrt(ahead * ahead + left * left);
    MF seen = distance - radius <= reach;
    if (p.narrow) {
      seen = hn::And(seen, p.edge_sin * ahead - p.edge_cos * left >= hn::Neg(radius));
      seen = hn::And(seen, p.edge_sin * ahead + p.edge_cos * left >= hn::Neg(radius));
    }
    std::uint32_t open = bits_of(seen);
    if (end - at < lanes()) open &= (1u << (end - at)) - 1;
    if (open == 0) continue;
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
    store(distance - radius, nearest), store(place - wide, lows), store(place + wide, highs);
    for (; open != 0; open &= open - 1) {
      const auto i = static_cast<std::uint32_t>(__builtin_ctz(open));
      if (grid.mover[at + i] == scene.self) continue;
      ++s.counts.movers_near;
      const NearMover near{nearest[i], grid.mover[at + i], lows[i], highs[i]};
      if (is_open(s, p, pattern, near)) s.near.push_back(near);
    }
  }
}

void find_all_near(Scratch& s, const Projection& p, const ScanView& view, const ScanPattern& pattern,
                   const ScanScene& scene) {
  const MoverGrid& grid = *scene.movers;
  const double reach = view.range_max * 1.00001 + grid.largest_radius + 2.0 * static_cast<double>(grid.error);
  const base::Vec2 v{view.origin.x - grid.low.x, view.origin.y - grid.low.y};
  const int x0 = grid.column_of(v.x - reach), x1 = grid.column_of(v.x + reach);
  s.near.clear();
  for (int row = grid.row_of(v.y - reach); row <= grid.row_of(v.y + reach); ++row)
    find_near(s, p, view, pattern, scene, grid.begin_of(x0, row), grid.begin_of(x1 + 1, row));
}

void draw_mover(Scratch& s, const Projection& p, const ScanView& view, const ScanPattern& pattern,
                const ScanScene& scene, const NearMover& near) {
  const OutlineTable::Outline& outline = scene.outlines->of_mover[near.mover];
  const base::Pose& X = scene.poses[near.mover];
  const VF c = constant(static_cast<float>(scene.headings[near.mover].x)),
           sn = constant(static_cast<float>(scene.headings[near.mover].y));
  const VF x = constant(static_cast<float>(X.x - view.origin.x)), y = constant(static_cast<float>(X.y - view.origin.y));
  const std::uint32_t count = near.distance > 1e-4f ? outline.outward : outline.all;
  const std::size_t first_live = s.live.size();
  for (std::uint32_t i = outline.first; i < outline.first + count; ++i) {
    const SegmentBlock& block = scene.outlines->blocks[i];
    for (std::uint32_t k = 0; k < kBlock; k += lanes()) {
      const VF ax = load(block.ax + k), ay = load(block.ay + k), ex = load(block.ex + k), ey = load(block.ey + k);
      project(s, p, x + (c * ax - sn * ay), y + (sn * ax + c * ay), c * ex - sn * ey, sn * ex + c * ey, block.row + k,
              scene.first_rows[near.mover]);
    }
  }
  draw_from(s, pattern, first_live);
}

void draw_movers(Scratch& s, const Projection& p, const ScanView& view, const ScanPattern& pattern,
                 const ScanScene& scene) {
  find_all_near(s, p, view, pattern, scene);
  s.order.clear();
  for (std::uint32_t i = 0; i < s.near.size(); ++i) {
    const float distance = std::max(s.near[i].distance, 0.0f);
    std::uint32_t word;
    std::memcpy(&word, &distance, sizeof word);
    s.order.push_back(std::uint64_t{word} << 32 | i);
  }
  std::sort(s.order.begin(), s.order.end());
  for (const std::uint64_t key : s.order) {
    const NearMover& near = s.near[key & 0xFFFFFFFFu];
    if (!is_open(s, p, pattern, near)) continue;
    ++s.counts.movers_met;
    draw_mover(s, p, view, pattern, scene, near);
  }
}

/// Bits of beams after which another segment is the nearest, and of those in doubt.
bool find_runs(Scratch& s, std::uint32_t beams) {
  std::fill(s.ends.begin(), s.ends.end(), 0);
  std::fill(s.doubts.begin(), s.doubts.end(), 0);
  s.winner[beams] = -2;
  bool doubt = false;
  for (std::uint32_t j = 0; j < beams; j += lanes()) {
    const auto changes = hn::LoadU(kI, &s.winner[j]) != hn::LoadU(kI, &s.winner[j + 1]);
    s.ends[j >> 6] |= std::uint64_t{bits_of(hn::RebindMask(kF, changes))} << (j & 63);
    const std::uint32_t unproven = bits_of(load(&s.near_low[j]) <= load(&s.others[j]));
    s.doubts[j >> 6] |= std::uint64_t{unproven} << (j & 63);
    doubt = doubt || unproven != 0;
  }
  if (beams % 64 != 0) {
    const std::uint64_t inside = (std::uint64_t{1} << (beams % 64)) - 1;
    s.ends[beams / 64] &= inside;
    s.doubts[beams / 64] &= inside;
  }
  return doubt;
}

/// Ranges of beams [first, end) that meet `g`, as `decide` has them.
inline void measure(const ScanView& view, const ScanPattern& pattern, const ExactSegment& g, std::uint32_t first,
                    std::uint32_t end, double* ranges) {
  const double wx = g.ax - view.origin.x, wy = g.ay - view.origin.y;
  const double ex = g.bx - g.ax, ey = g.by - g.ay;
  const VD above = hn::Set(kD, ex * wy - ey * wx), dx = hn::Set(kD, ex), dy = hn::Set(kD, ey);
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
    const VD range = hn::Max(above / (dx * y - dy * x), least);
    if (j + step <= pattern.beams) {
      hn::StoreU(range, kD, &ranges[j]);  // behind `end` the next run follows
    } else {
      HWY_ALIGN double last[kBlock];
      hn::Store(range, kD, last);
      std::copy(last, last + (pattern.beams - j), &ranges[j]);
    }
  }
}

void scan(Scratch& s, const ScanView& view, const ScanPattern& pattern, const ScanScene& scene) {
  s.begin(pattern.beams);
  const auto inverse = static_cast<float>(1.0 / view.range_max);
  for (std::uint32_t j = 0; j < pattern.beams; j += lanes()) {
    store(constant(inverse * (1.0f - 1e-6f)), &s.near_low[j]);
    store(constant(inverse * (1.0f + 1e-6f)), &s.near_high[j]);
    store(constant(0.0f), &s.others[j]);
    hn::StoreU(hn::Set(kI, -1), kI, &s.winner[j]);
  }
  const Projection p = projection_of(view, pattern);
  draw_walls(s, p, view, pattern, scene);
  if (scene.movers != nullptr) draw_movers(s, p, view, pattern, scene);
}

/// The same ranges in 32 bits.
void measure_in_32_bits(const ScanView& view, const ScanPattern& pattern, const ExactSegment& g, std::uint32_t first,
                        std::uint32_t end, double* ranges) {
  for (std::uint32_t j = first; j < end; ++j) {
    const float t = measure_single(g, view.origin, direction_of(view, pattern, j), static_cast<float>(view.range_max));
    if (t >= 0.0f) ranges[j] = std::max(std::min(static_cast<double>(t), view.range_max), view.range_min);
  }
}

/// Calls `visit(first, end, winner)` for the beams [first, end) of one winner each.
template <class Visit>
HWY_INLINE void each_run(const Scratch& s, Visit visit) {
  std::uint32_t first = 0;
  for (std::size_t w = 0; w < s.ends.size(); ++w)
    for (std::uint64_t open = s.ends[w]; open != 0; open &= open - 1) {
      const auto end = static_cast<std::uint32_t>(64 * w) + static_cast<std::uint32_t>(__builtin_ctzll(open)) + 1;
      visit(first, end, s.winner[first]);
      first = end;
    }
}

bool answer(Scratch& s, const ScanView& view, const ScanPattern& pattern, const ScanScene& scene,
            const ScanOutput& out) {
  const bool doubt = find_runs(s, pattern.beams);
  each_run(s, [&](std::uint32_t, std::uint32_t, std::int32_t k) {
    if (k >= 0) __builtin_prefetch(&scene.exact[s.row[static_cast<std::uint32_t>(k)]]);
  });
  each_run(s, [&](std::uint32_t first, std::uint32_t end, std::int32_t k) {
    const std::uint32_t row = k < 0 ? SF_NO_HIT : s.row[static_cast<std::uint32_t>(k)];
    if (k < 0)
      std::fill(&out.ranges[first], &out.ranges[end], std::max(view.range_max, view.range_min));
    else
      measure(view, pattern, scene.exact[row], first, end, out.ranges);
    if (k >= 0 && view.single) measure_in_32_bits(view, pattern, scene.exact[row], first, end, out.ranges);
    std::fill(&out.models[first], &out.models[end], k < 0 ? SF_NO_HIT : scene.models[row]);
  });
  return doubt;
}

/// Segments of a block that direction `d` may cross, those behind the viewer too: a bit each. Start and extent are
/// turned by `heading` and moved by `from`.
inline std::uint32_t crossed_by(const SegmentBlock& block, base::Vec2 from, base::Vec2 heading, base::Vec2 d,
                                float band) {
  const VF c = constant(static_cast<float>(heading.x)), sn = constant(static_cast<float>(heading.y));
  const VF x = constant(static_cast<float>(from.x)), y = constant(static_cast<float>(from.y));
  const VF dx = constant(static_cast<float>(d.x)), dy = constant(static_cast<float>(d.y)), slip = constant(2.0f * band);
  std::uint32_t found = 0;
  for (std::uint32_t k = 0; k < kBlock; k += lanes()) {
    const VF ax = load(block.ax + k), ay = load(block.ay + k), ex = load(block.ex + k), ey = load(block.ey + k);
    const VF wx = x + (c * ax - sn * ay), wy = y + (sn * ax + c * ay), gx = c * ex - sn * ey, gy = sn * ex + c * ey;
    const VF start = dx * wy - dy * wx, end = start + (dx * gy - dy * gx);
    const MF apart = hn::Or(hn::Min(start, end) > slip, hn::Max(start, end) < hn::Neg(slip));
    found |= bits_of(hn::Not(apart)) << k;
  }
  return found;
}

/// Decides those of a block that beam `d` may cross.
void meet(const ScanView& view, const ScanScene& scene, const SegmentBlock& block, base::Vec2 from, base::Vec2 heading,
          std::uint32_t first_row, base::Vec2 d, Decision& best) {
  for (std::uint32_t open = crossed_by(block, from, heading, d, view.band); open != 0; open &= open - 1) {
    const std::uint32_t number = block.row[__builtin_ctz(open)];
    if (number != SF_NO_HIT) decide({scene.exact[first_row + number], first_row + number}, view.origin, d, best);
  }
}

void meet_walls(const ScanView& view, const ScanScene& scene, base::Vec2 d, Decision& best) {
  const auto bearing = static_cast<float>(std::atan2(d.y, d.x));
  for (const auto& blocks : {scene.walls, scene.behind})
    for (const SegmentBlock& block : blocks) {
      const float turned = std::abs(block.bearing - bearing);
      const float apart = std::min(turned, std::abs(6.2831853f - turned));
      if (apart > block.half + 1e-5f || static_cast<double>(block.nearest) > best.range) continue;
      meet(view, scene, block, -1.0 * view.offset, {1.0, 0.0}, 0, d, best);
    }
}

/// Lists movers of one row of cells whose discs beam `d` may cross within `range`.
void find_across(Scratch& s, const ScanView& view, const ScanScene& scene, base::Vec2 d, double range,
                 std::uint32_t from, std::uint32_t end) {
  const MoverGrid& grid = *scene.movers;
  const VF x = constant(static_cast<float>(view.origin.x - grid.low.x));
  const VF y = constant(static_cast<float>(view.origin.y - grid.low.y));
  const VF ux = constant(static_cast<float>(d.x)), uy = constant(static_cast<float>(d.y));
  const VF reach = constant(static_cast<float>(range) * 1.00001f), slip = constant(grid.error + view.band);
  for (std::uint32_t at = from; at < end; at += lanes()) {
    const VF dx = load(&grid.x[at]) - x, dy = load(&grid.y[at]) - y;
    const VF radius = load(&grid.radius[at]) * constant(1.0001f) + slip;
    const VF along = dx * ux + dy * uy, aside = hn::Abs(dx * uy - dy * ux);
    const MF across = hn::And(hn::And(aside <= radius, along >= hn::Neg(radius)), along - radius <= reach);
    std::uint32_t open = bits_of(across);
    if (end - at < lanes()) open &= (1u << (end - at)) - 1;
    for (; open != 0; open &= open - 1) {
      const std::uint32_t mover = grid.mover[at + static_cast<std::uint32_t>(__builtin_ctz(open))];
      if (mover != scene.self) s.across.push_back(mover);
    }
  }
}

void meet_movers(Scratch& s, const ScanView& view, const ScanScene& scene, base::Vec2 d, Decision& best) {
  const MoverGrid& grid = *scene.movers;
  const double margin = grid.largest_radius * 1.001 + 2.0 * static_cast<double>(grid.error);
  const base::Vec2 from{view.origin.x - grid.low.x, view.origin.y - grid.low.y}, to = from + best.range * d;
  const int x0 = grid.column_of(std::min(from.x, to.x) - margin), x1 = grid.column_of(std::max(from.x, to.x) + margin);
  const int y0 = grid.row_of(std::min(from.y, to.y) - margin), y1 = grid.row_of(std::max(from.y, to.y) + margin);
  s.across.clear();
  for (int row = y0; row <= y1; ++row)
    find_across(s, view, scene, d, best.range, grid.begin_of(x0, row), grid.begin_of(x1 + 1, row));
  for (const std::uint32_t mover : s.across) {
    const OutlineTable::Outline& outline = scene.outlines->of_mover[mover];
    const base::Vec2 place = base::Vec2{scene.poses[mover].x, scene.poses[mover].y} - view.origin;
    for (std::uint32_t i = outline.first; i < outline.first + outline.all; ++i)
      meet(view, scene, scene.outlines->blocks[i], place, scene.headings[mover], scene.first_rows[mover], d, best);
  }
}

/// A beam against all that lies across it, in 64 bits.
Decision decide_beam(Scratch& s, const ScanView& view, const ScanScene& scene, base::Vec2 d) {
  Decision best{view.range_max};
  meet_walls(view, scene, d, best);
  if (scene.movers != nullptr) meet_movers(s, view, scene, d, best);
  return best;
}

/// @return whether any beam is in doubt
bool scan_all(Scratch& s, const ScanView& view, const ScanPattern& pattern, const ScanScene& scene,
              const ScanOutput& out) {
  scan(s, view, pattern, scene);
  return answer(s, view, pattern, scene, out);
}

const char* instructions() { return hwy::TargetName(HWY_TARGET); }

}  // namespace sf::raycast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sf::raycast {

HWY_EXPORT(scan_all);
HWY_EXPORT(decide_beam);
HWY_EXPORT(instructions);

void Rasterizer::Scratch::begin(std::uint32_t beams) {
  const std::size_t padded = std::size_t{beams} + 2 * kBlock;
  if (near_low.size() < padded) {
    near_low.resize(padded), near_high.resize(padded), others.resize(padded), winner.resize(padded);
  }
  ends.resize(beams / 64 + 1);
  doubts.resize(beams / 64 + 1);
  live.clear();
  used = 0;
}

void Rasterizer::Scratch::reserve(std::uint32_t more) {
  const std::size_t needed = std::size_t{used} + more;
  if (a.size() >= needed) return;
  const std::size_t room = 2 * needed + 256;
  for (std::vector<float>* v : {&a, &b, &error, &low_any, &high_any, &low_sure, &high_sure}) v->resize(room);
  first.resize(room), last.resize(room), row.resize(room);
}

Rasterizer::Rasterizer() : scratch_(std::make_unique<Scratch>()) {}
Rasterizer::~Rasterizer() = default;
Rasterizer::Rasterizer(Rasterizer&&) noexcept = default;

const ScanCounts& Rasterizer::counts() const { return scratch_->counts; }

namespace {

/// Answers beam `i` in 64 bits, against all. @return whether it grazes
bool answer_beam(Rasterizer::Scratch& s, const ScanView& view, const ScanPattern& pattern, const ScanScene& scene,
                 std::size_t i, const ScanOutput& out) {
  const base::Vec2 d = direction_of(view, pattern, i);
  Decision best = HWY_DYNAMIC_DISPATCH(decide_beam)(s, view, scene, d);
  const bool grazes = best.grazes(static_cast<float>(view.least_sine));
  if (view.single && best.id != SF_NO_HIT) {
    const float t = measure_single(scene.exact[best.id], view.origin, d, static_cast<float>(view.range_max));
    if (t >= 0.0f) best.range = std::min(static_cast<double>(t), view.range_max);
  }
  out.ranges[i] = std::max(best.range, view.range_min);
  out.models[i] = best.id == SF_NO_HIT ? SF_NO_HIT : scene.models[best.id];
  out.grazes[i] = grazes ? 1 : 0;
  return grazes;
}

}  // namespace

bool Rasterizer::scan(const ScanView& view, const ScanPattern& pattern, const ScanScene& scene, const ScanOutput& out) {
  Scratch& s = *scratch_;
  bool grazes = false;
  if (pattern.beams <= kFewBeams) {
    for (std::size_t i = 0; i < pattern.beams; ++i) grazes |= answer_beam(s, view, pattern, scene, i, out);
    return grazes;
  }
  if (!HWY_DYNAMIC_DISPATCH(scan_all)(s, view, pattern, scene, out)) return false;
  std::fill_n(out.grazes, pattern.beams, std::uint8_t{0});
  for (std::size_t w = 0; w < s.doubts.size(); ++w)
    for (std::uint64_t open = s.doubts[w]; open != 0; open &= open - 1) {
      const std::size_t i = 64 * w + static_cast<std::size_t>(__builtin_ctzll(open));
      grazes |= answer_beam(s, view, pattern, scene, i, out);
      ++s.counts.doubts;
    }
  return grazes;
}

const char* vector_instructions() { return HWY_DYNAMIC_DISPATCH(instructions)(); }

}  // namespace sf::raycast
#endif
