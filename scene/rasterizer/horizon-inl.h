// Computes the horizon of a scan over a height field, sixteen blocks at a time. Compiled once per instruction set
// (hwy/foreach_target.h).

#if defined(SF_SCENE_HORIZON_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SF_SCENE_HORIZON_INL_H
#undef SF_SCENE_HORIZON_INL_H
#else
#define SF_SCENE_HORIZON_INL_H
#endif

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "scene/field_view.h"
#include "scene/horizon.h"
#include "scene/rasterizer/vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sf::scene::HWY_NAMESPACE {

constexpr double kInnermost = 4.0;  ///< [cells] radius of the innermost ring
constexpr float kQuarter = 0.25f * Horizon::kSectors;

// The bits of 1.0f, and the bits above those that rings do not have: rings end where two bits of the fraction change.
constexpr std::int32_t kFirstRing = 0x3F800000 - (1 << 21), kRingShift = 21;

/// Number of rings that end within a distance, in units of the innermost.
HWY_INLINE Ints rings_within(const Floats& distance) {
  return larger((bits_of_floats(distance) - all(kFirstRing)) >> all(kRingShift), all(0));
}
/// Distance where the last of some rings ends; 0 without a ring.
HWY_INLINE Floats end_of_rings(const Ints& rings) {
  return select_or_zero(greater(rings, all(0)), floats_with_bits((rings << all(kRingShift)) + all(kFirstRing)));
}

/// Sector of a direction as a fraction in [0, kSectors]: monotonic in the azimuth. @param part y / (|x| + |y|)
HWY_INLINE Floats sector_of(const Floats& x, const Floats& part) {
  return muladd(select(at_least(x, all(0.0f)), part, all(2.0f) - part), all(kQuarter), all(kQuarter));
}

/// Corners of a tile's box of directions, in a height field's frame. Those of a diagonal: 0 and 3.
inline std::array<glm::dvec3, 4> corners_of(const BeamTile& tile, const glm::dmat3& R) {
  const auto row = [&](int k) {
    return R * glm::dvec3{tile.tile.box[k][0], tile.tile.box[k + 1][0], tile.tile.box[k + 2][0]};
  };
  const glm::dvec3 c = row(0), u = row(3), v = row(6);
  return {c - u - v, c - u + v, c + u - v, c + u + v};
}

/// Box of a scan's horizontal directions, of length |x| + |y| = 1.
struct Azimuths {
  glm::dvec2 low{1.0}, high{-1.0};
  /// @param corners of a box of directions
  void add(const std::array<glm::dvec3, 4>& corners);
  void add(glm::dvec2 point) { low = glm::min(low, point - 1e-3), high = glm::max(high, point + 1e-3); }
};

void Azimuths::add(const std::array<glm::dvec3, 4>& corners) {
  const glm::dvec2 middle(corners[0] + corners[3]);
  glm::dvec2 least(HUGE_VAL), most(-HUGE_VAL);
  for (const glm::dvec3& direction : corners) {
    const glm::dvec2 corner(direction);
    if (!(glm::dot(corner, middle) > 0.1 * glm::length(corner) * glm::length(middle))) low = {-1, -1}, high = {1, 1};
    add(corner / (std::abs(corner.x) + std::abs(corner.y) + 1e-30));
    least = glm::min(least, corner), most = glm::max(most, corner);
  }
  if (least.y < 0.0 && most.y > 0.0) add({std::copysign(1.0, middle.x), 0.0});
  if (least.x < 0.0 && most.x > 0.0) add({0.0, std::copysign(1.0, middle.y)});
}

/// Sixteen blocks of a row. Arrays: sides at the smaller and the larger coordinate.
struct Blocks {
  Floats x[2], y[2];    ///< [m] from the sensor
  Floats height[2][2];  ///< [m] of the plane over each corner, at [x][y], from the sensor
};

/// The blocks as seen from the sensor.
struct BlocksInView {
  Floats near, far;    ///< [m]
  Floats first, last;  ///< sectors; beyond kSectors: those from 0 on
  Floats slope;        ///< bound of beams that meet them
};

class HorizonBuilding {
 public:
  HorizonBuilding(const FieldView& view, const Azimuths& azimuths, Horizon& out)
      : v_(view), f_(*view.field), azimuths_(azimuths), out_(out) {}
  void run();

 private:
  void set_rings();
  void add_annulus(double from, double to, std::int32_t level);
  HWY_INLINE Blocks blocks_at(std::int32_t x, std::int32_t y, std::int32_t level) const;
  HWY_INLINE BlocksInView view(const Blocks& blocks) const;
  HWY_INLINE void add(const BlocksInView& blocks, const Mask& used, float from);
  /// [m] from the sensor
  double metres(int axis, std::int32_t line) const { return ((line - v_.base[axis]) - v_.from[axis]) * f_.cell[axis]; }

  const FieldView& v_;
  const HeightField& f_;
  const Azimuths& azimuths_;
  Horizon& out_;
};

void HorizonBuilding::set_rings() {
  const double inner = kInnermost * std::max(f_.cell.x, f_.cell.y);
  const auto reach = [&](int axis, std::int32_t points) {
    return std::max(std::abs(metres(axis, 0)), std::abs(metres(axis, points - 1)));
  };
  const double last = std::min(v_.range_max * M_SQRT2, reach(0, f_.columns) + reach(1, f_.rows)) * 1.00001;
  out_.inner = static_cast<float>(inner), out_.last = static_cast<float>(last);
  const auto bits = std::bit_cast<std::int32_t>(static_cast<float>(std::max(1.0, last / inner)));
  out_.rings = std::min(((bits - kFirstRing) >> kRingShift) + 1, Horizon::kMostRings);
  for (auto& sector : out_.slope)
    for (std::int32_t k = 0; k < Horizon::kMostRings; ++k) sector[k] = k < out_.rings ? -HUGE_VALF : HUGE_VALF;
}

Blocks HorizonBuilding::blocks_at(std::int32_t x, std::int32_t y, std::int32_t level) const {
  const std::int32_t row = y - (f_.bias >> level) + f_.bias / 2;
  Floats height, slopes;
  load_pairs(&f_.above[static_cast<std::size_t>(row) * static_cast<std::size_t>(f_.pitch) + static_cast<std::size_t>(x)]
                  .height,
             height, slopes);
  const Ints low = (all(x) + lane_numbers()) << all(level), high = smaller(low + all(1 << level), all(f_.columns - 1));
  const std::int32_t low_y = y << level, high_y = std::min(low_y + (1 << level), f_.rows - 1);
  const auto place = [&](const Ints& line) {
    return (floats_of(line - all(v_.base.x)) - all(static_cast<float>(v_.from.x))) * all(static_cast<float>(f_.cell.x));
  };
  const Ints packed = bits_of_floats(slopes), half = all(16);
  const Floats along = floats_of(packed << half >> half) * floats_of(high - low) * all(f_.slope_unit);
  const Floats across = floats_of(packed >> half) * all(static_cast<float>(high_y - low_y) * f_.slope_unit);
  const Floats first = height - all(static_cast<float>(v_.z));
  return {{place(low), place(high)},
          {all(static_cast<float>(metres(1, low_y))), all(static_cast<float>(metres(1, high_y)))},
          {{first, first + across}, {first + along, first + (along + across)}}};
}

BlocksInView HorizonBuilding::view(const Blocks& blocks) const {
  const Floats zero = all(0.0f);
  const auto nearest = [&](const Floats(&v)[2]) { return larger(larger(v[0], zero - v[1]), zero); };
  const auto farthest = [&](const Floats(&v)[2]) { return larger(absolute(v[0]), absolute(v[1])); };
  BlocksInView out{nearest(blocks.x) + nearest(blocks.y), farthest(blocks.x) + farthest(blocks.y), all(HUGE_VALF),
                   all(-HUGE_VALF), all(-HUGE_VALF)};
  const Floats room = all(3.0f) * muladd(all(v_.error32_per_metre), out.far, all(v_.error32));
  const Mask behind = both(greater(zero, blocks.x[0]), greater(zero, blocks.y[0]));
  Floats top = out.slope;
  for (int i = 0; i < 2; ++i)
    for (int k = 0; k < 2; ++k) {
      const Floats x = blocks.x[i], y = blocks.y[k], height = blocks.height[i][k];
      const Floats inverse = all(1.0f) / larger(absolute(x) + absolute(y), all(1e-30f));
      const Floats over = muladd(absolute(height), all(3.0f * v_.error32_per_metre + 1e-6f), height + room);
      top = larger(top, over), out.slope = larger(out.slope, over * inverse);
      const Mask beyond = both(behind, at_least(x, zero));  // in a block on both sides of the first sector
      const Floats sector = sector_of(x, y * inverse) + select_or_zero(beyond, all(1.0f * Horizon::kSectors));
      out.first = smaller(out.first, sector), out.last = larger(out.last, sector);
    }
  const Mask around = greater(all(1e-6f) * out.far, out.near);
  out.first = select(around, zero, out.first), out.last = select(around, all(Horizon::kSectors - 1.0f), out.last);
  const Floats steep = select(around, all(HUGE_VALF), top / out.near);
  out.slope = select(at_least(top, zero), steep, muladd(absolute(out.slope), all(2e-6f), out.slope));
  return out;
}

void HorizonBuilding::add(const BlocksInView& blocks, const Mask& used, float from) {
  alignas(64) float slope[kWidth];
  alignas(64) std::int32_t ring[kWidth], first[kWidth], last[kWidth];
  constexpr float kMargin = 1e-3f;
  store(blocks.slope, slope);
  const Ints passed = rings_within(larger(blocks.near, all(from)) * all(0.99999f / out_.inner));
  store(smaller(passed, all(out_.rings - 1)), ring);
  store(floor_near(blocks.first - all(kMargin)), first), store(floor_near(blocks.last + all(kMargin)), last);
  for (std::uint32_t rest = bits_of(used); rest != 0; rest &= rest - 1) {
    const auto i = static_cast<std::uint32_t>(__builtin_ctz(rest));
    for (std::int32_t s = first[i]; s <= last[i]; ++s) {
      float& most = out_.slope[s & (Horizon::kSectors - 1)][ring[i]];
      most = std::max(most, slope[i]);
    }
  }
}

/// Adds the blocks between two distances.
void HorizonBuilding::add_annulus(double from, double to, std::int32_t level) {
  const auto line_of = [&](int axis, double distance, std::int32_t points) {
    const double line = v_.base[axis] + v_.from[axis] + distance / f_.cell[axis];
    return static_cast<std::int32_t>(std::clamp(std::floor(line), 0.0, points - 2.0)) >> level;
  };
  const glm::dvec2 low = glm::min(azimuths_.low * from, azimuths_.low * to);
  const glm::dvec2 high = glm::max(azimuths_.high * from, azimuths_.high * to);
  const std::int32_t last = line_of(1, high.y, f_.rows);
  for (std::int32_t y = line_of(1, low.y, f_.rows); y <= last; ++y) {
    const double near = std::max({0.0, metres(1, y << level), -metres(1, (y + 1) << level)});
    const std::int32_t end = line_of(0, std::min(high.x, to - near), f_.columns);
    for (std::int32_t x = line_of(0, std::max(low.x, near - to), f_.columns); x <= end; x += kWidth) {
      const BlocksInView blocks = view(blocks_at(x, y, level));
      const Mask within =
          both(at_least(blocks.far, all(static_cast<float>(from))), at_least(all(static_cast<float>(to)), blocks.near));
      add(blocks, both(within, greater(all(end - x + 1), lane_numbers())), static_cast<float>(from));
    }
  }
}

void HorizonBuilding::run() {
  set_rings();
  const double last = out_.last;
  double from = 0.0, to = out_.inner;
  for (std::int32_t octave = 0; from < last; ++octave, from = to, to *= 2.0)
    add_annulus(from, std::min(to, last), std::clamp(octave - 2, 1, f_.levels));
  out_.highest = -HUGE_VALF;
  for (auto& sector : out_.slope) {
    for (std::int32_t k = 1; k < out_.rings; ++k) sector[k] = std::max(sector[k], sector[k - 1]);
    out_.highest = std::max(out_.highest, sector[out_.rings - 1]);
  }
}

/// @param view of a sensor over the field and certainly above it  @param tiles of the scan
inline void build_horizon(const FieldView& view, std::span<const BeamTile> tiles, Horizon& out) {
  Azimuths azimuths;
  for (const BeamTile& tile : tiles) azimuths.add(corners_of(tile, view.X_FS.R));
  HorizonBuilding(view, azimuths, out).run();
}

}  // namespace sf::scene::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
