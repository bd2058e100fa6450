// Walks the beams of a vector over a height field, from block to block of its pyramid, to the cells where they meet it.
// Compiled once per instruction set (hwy/foreach_target.h). Bounds of errors: field_view.h.

#if defined(SF_SCENE_SEARCH_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SF_SCENE_SEARCH_INL_H
#undef SF_SCENE_SEARCH_INL_H
#else
#define SF_SCENE_SEARCH_INL_H
#endif

#include "scene/rasterizer/horizon-inl.h"
#include "scene/rasterizer/ranges-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sf::scene::HWY_NAMESPACE {

/// Coordinates of a vector's beams in the field's frame.
struct FieldRays {
  alignas(64) double x[kWidth], y[kWidth], z[kWidth];  ///< FieldRay
  FieldRay at(std::uint32_t i) const { return {x[i], y[i], z[i]}; }
};

/// Points of sixteen beams. Before them, no beam certainly meets the field.
struct FieldPoints {
  Ints x, y;  ///< cells; y: less HeightField::bias
  Floats t;   ///< [m]
};

/// Where beams meet the field. Lanes in none of these miss it.
struct Found {
  Mask sure, upper;  ///< the triangle of the cell at its point
  Mask unsure;       ///< 32 bits cannot decide from its point on
};

constexpr std::int32_t kFirstLevel = 4;  ///< of blocks where searches from outside start

/// Where beams cross their blocks.
struct Crossing {
  Ints low_x, low_y, line_x, line_y;  ///< corners of the blocks, and the lines where beams leave
  Mask through_x;                     ///< they leave through a line x = constant
  Floats x, y;                        ///< [cells] the sensor's place from the corner
  Floats out;                         ///< [m]
};

/// Heights of the beams above one surface, which is that of each lane's cell.
struct CellHeights {
  Floats a, across, along, opposite;  ///< [m] corner a, and the differences of the others from it
  Floats x, y;                        ///< the sensor's place from corner a
  HWY_INLINE Floats above(const Floats& t, const Floats& dx, const Floats& dy, const Floats& dz) const {
    const Floats px = muladd(t, dx, x), py = muladd(t, dy, y), zero = all(0.0f);
    const Floats height = muladd(across, larger(px - py, zero),
                                 muladd(along, larger(py - px, zero), muladd(opposite, smaller(px, py), a)));
    return mulsub(t, dz, height);
  }
};

HWY_INLINE Floats reciprocal(const Floats& v) {
  const Floats least = all(1e-30f), size = larger(absolute(v), least);
  return turned(all(1.0f) / size, v);
}

/// The search of sixteen beams. All heights are multiplied by `side`, so that beams come from above.
class Search {
 public:
  Search() = default;
  HWY_INLINE void begin(const FieldView& view, const FieldRays& rays, float side, const Floats& end);
  /// Starts from points before which the beams certainly do not meet the field.
  HWY_INLINE void start(const FieldPoints& points, const Mask& active, const Ints& level) {
    const Mask no = greater(all(0.0f), all(0.0f));
    points_ = points, active_ = active, found_ = {no, no, no};
    level_ = smaller(level, all(field_->levels));
  }
  /// Starts from the sensor, or from where the beams come close to the surface.
  HWY_INLINE void start(const Horizon& horizon);
  HWY_INLINE bool done() const { return none(active_); }
  HWY_INLINE void step();
  const Found& found() const { return found_; }
  const FieldPoints& points() const { return points_; }

  /// Sets where the beams enter and leave the field, widened by `room` [cells].
  HWY_INLINE void enter(const Floats& room, Floats& in, Floats& out) const;
  /// Cells at some points of the beams: the field's nearest.
  HWY_INLINE FieldPoints points_at(const Floats& t) const {
    const Ints one = all(1);
    return {smaller(larger(x_at(t), all(0)), cells_x_ - one), smaller(larger(y_at(t), low_y_), end_y_ - one), t};
  }
  /// Height of the beams above the surface at their points.
  HWY_INLINE Floats above(const FieldPoints& points) const {
    const CellHeights cell = cell_at(points.x, points.y, from_x_ - floats_of(points.x - origin_x()),
                                     from_y_ - floats_of(points.y - origin_y()));
    return cell.above(points.t, dx_, dy_, dz_);
  }
  /// [cells] bound of the error of a place on the beams.
  HWY_INLINE Floats room() const { return place_error(end_); }
  HWY_INLINE Floats error_at(const Floats& t) const { return muladd(error_per_metre_, t, error_); }

 private:
  HWY_INLINE Crossing crossing() const;
  HWY_INLINE void step_blocks(const Mask& moving);
  HWY_INLINE void step_cells();
  HWY_INLINE void move(const Crossing& at, const Mask& moving, const Mask& clear, const Floats& next,
                       const Floats& room);
  HWY_INLINE void end(const Crossing& at, const Mask& crossing, const Ints& x, const Ints& y, const Floats& room);
  HWY_INLINE CellHeights cell_at(const Ints& x, const Ints& y, const Floats& place_x, const Floats& place_y) const;
  HWY_INLINE Mask certain(const CellHeights& cell, const Floats& from, const Floats& to, const Floats& high,
                          const Floats& low, const Floats& error, Mask& upper) const;
  HWY_INLINE Ints origin_x() const { return all(view_->base.x); }
  HWY_INLINE Ints origin_y() const { return all(view_->base.y - field_->bias); }
  /// Cells that are not at the border.
  HWY_INLINE Mask inner(const Ints& x, const Ints& y) const {
    return both(both(greater(x, all(0)), greater(cells_x_ - all(1), x)),
                both(greater(y, low_y_), greater(end_y_ - all(1), y)));
  }
  /// [cells] bound of the error of a place at `t`.
  HWY_INLINE Floats place_error(const Floats& t) const {
    return muladd(all(view_->border32_per_metre), t, all(view_->border32));
  }
  /// Cells at some points, or their neighbours where rounding decides.
  HWY_INLINE Ints x_at(const Floats& t) const { return nearest_bits(muladd(t, dx_, middle_x_)) + all(cell_x_); }
  HWY_INLINE Ints y_at(const Floats& t) const { return nearest_bits(muladd(t, dy_, middle_y_)) + all(cell_y_); }

  const FieldView* view_ = nullptr;
  const HeightField* field_ = nullptr;
  float side_ = 1.0f, z_ = 0.0f;
  const BoundingPlane* planes_ = nullptr;
  Floats dx_, dy_, dz_, per_x_, per_y_, per_turn_, end_, from_x_, from_y_, error_, error_per_metre_;
  Floats middle_x_, middle_y_;  ///< [cells] the sensor's place less 0.5
  Floats inside_;               ///< [m] until there, beams certainly neither leave the field nor end
  Floats tilt_x_, tilt_y_;      ///< directions in BoundingPlane's units
  float plane_z_, plane_error_per_metre_, slope_unit_;
  std::int32_t cell_x_, cell_y_;  ///< the sensor's cell, less kNearestBits
  Ints step_x_, step_y_, cells_x_, low_y_, end_y_;

  FieldPoints points_;
  Ints level_;  ///< of the blocks that come next; 0: cells
  Mask active_;
  Found found_;
};

/// Loads pairs of floats from from[stride row] and the next. @tparam stride 1 or 2
template <int stride = 1>
HWY_INLINE void gather_pairs(const float* from, const Ints& rows, Floats& first, Floats& second) {
#if HWY_TARGET == HWY_SCALAR
  const Ints at = stride == 1 ? rows : rows + rows;
  first = gather(from, at), second = gather(from + 1, at);
#else
  constexpr hn::CappedTag<std::uint64_t, kLanes / 2> kPair;
  constexpr hn::RebindToSigned<decltype(kPair)> kOffset;
  constexpr hn::Rebind<std::int32_t, decltype(kPair)> kHalf;
  const auto* const pairs = reinterpret_cast<const std::uint64_t*>(from);
  for (std::size_t p = 0; p < kParts; ++p) {
    const auto low = hn::ShiftLeft<1 + stride>(hn::PromoteTo(kOffset, hn::LowerHalf(kHalf, rows.part[p])));
    const auto high = hn::ShiftLeft<1 + stride>(hn::PromoteTo(kOffset, hn::UpperHalf(kHalf, rows.part[p])));
    const auto a = hn::BitCast(kF, hn::GatherOffset(kPair, pairs, low));
    const auto b = hn::BitCast(kF, hn::GatherOffset(kPair, pairs, high));
    first.part[p] = hn::ConcatEven(kF, b, a), second.part[p] = hn::ConcatOdd(kF, b, a);
  }
#endif
}

HWY_INLINE Floats as_floats(const double* v, double scale) {
  alignas(64) float out[kWidth];
  for (std::uint32_t i = 0; i < kWidth; ++i) out[i] = static_cast<float>(v[i] * scale);
  return load(out);
}

void Search::begin(const FieldView& view, const FieldRays& rays, float side, const Floats& end) {
  view_ = &view, field_ = view.field, side_ = side, z_ = static_cast<float>(view.z * side), end_ = end;
  planes_ = (side > 0.0f ? field_->above : field_->below).data() +
            static_cast<std::ptrdiff_t>(field_->bias / 2) * field_->pitch;
  dx_ = as_floats(rays.x, 1.0), dy_ = as_floats(rays.y, 1.0), dz_ = as_floats(rays.z, side);
  const Floats zero = all(0.0f);
  from_x_ = all(static_cast<float>(view.from.x)), from_y_ = all(static_cast<float>(view.from.y));
  step_x_ = select(at_least(dx_, zero), all(1), all(0)), step_y_ = select(at_least(dy_, zero), all(1), all(0));
  cells_x_ = all(field_->columns - 1), low_y_ = all(-field_->bias), end_y_ = all(field_->rows - 1 - field_->bias);
  error_ = all(view.error32), error_per_metre_ = all(view.error32_per_metre);
  per_x_ = reciprocal(dx_), per_y_ = reciprocal(dy_), per_turn_ = reciprocal(dx_ - dy_);
  middle_x_ = from_x_ - all(0.5f), middle_y_ = from_y_ - all(0.5f);
  cell_x_ = view.base.x - kNearestBits, cell_y_ = view.base.y - field_->bias - kNearestBits;
  slope_unit_ = field_->slope_unit * 0x1p-16f;
  tilt_x_ = dx_ * all(slope_unit_), tilt_y_ = dy_ * all(slope_unit_);
  plane_z_ = z_ - 2.0f * view.error32, plane_error_per_metre_ = 2.0f * view.error32_per_metre;
  Floats in;
  enter(zero - room(), in, inside_);
}

void Search::enter(const Floats& room, Floats& in, Floats& out) const {
  const auto along = [&](std::int32_t base, std::int32_t cells, const Floats& from, const Floats& inverse) {
    const Floats low = (all(static_cast<float>(-base)) - from - room) * inverse;
    const Floats high = (all(static_cast<float>(cells - base)) - from + room) * inverse;
    in = larger(in, smaller(low, high)), out = smaller(out, larger(low, high));
  };
  in = all(0.0f), out = end_;
  along(view_->base.x, field_->columns - 1, from_x_, per_x_);
  along(view_->base.y, field_->rows - 1, from_y_, per_y_);
}

void Search::start(const Horizon& horizon) {
  constexpr std::int32_t kRound = Horizon::kSectors;
  const Floats x = dx_ * all(static_cast<float>(field_->cell.x)), y = dy_ * all(static_cast<float>(field_->cell.y));
  const Floats zero = all(0.0f), width = larger(absolute(x) + absolute(y), all(1e-30f));
  const Floats sector = sector_of(x, y / width);
  auto first = static_cast<std::int32_t>(least(sector) - 0.001f + kRound) - kRound;
  auto last = static_cast<std::int32_t>(0.001f - least(zero - sector));
  if (last - first > kRound / 2) {  // on both sides of the first sector
    const Floats turned = select(greater(sector, all(0.5f * kRound)), sector - all(1.0f * kRound), sector);
    first = static_cast<std::int32_t>(least(turned) - 0.001f + kRound) - kRound;
    last = static_cast<std::int32_t>(0.001f - least(zero - turned) + kRound) - kRound;
  }
  const Floats slope = dz_ / width, sure = slope - muladd(absolute(slope), all(1e-6f), all(1e-6f));
  const Floats lowest = all(least(sure));
  alignas(64) float most[Horizon::kMostRings];
  std::int32_t common = 0;  // rings within which all beams stay above the ground
  for (std::int32_t k = 0; k < horizon.rings; k += kWidth) {
    Floats slopes = all(-HUGE_VALF);
    for (std::int32_t s = first; s <= last; ++s) slopes = larger(slopes, load(&horizon.slope[s & (kRound - 1)][k]));
    store(slopes, most + k);
    common += __builtin_popcount(bits_of(greater(lowest, slopes)));
  }
  Ints rings = all(common);
  for (std::int32_t k = common; k < horizon.rings; ++k) {
    const Mask over = greater(sure, all(most[k]));
    if (none(over)) break;
    rings = select(over, all(k + 1), rings);
  }
  const Floats reach = smaller(end_of_rings(rings) * all(horizon.inner), all(horizon.last));
  const Ints level = larger(rings >> all(2), all(1));
  const Mask ends = greater(rings, all(horizon.rings - 1));
  if (none(without(at_least(end_, zero), ends))) {  // all beams stay above the ground
    const Mask no = greater(zero, zero);
    active_ = no, found_ = {no, no, no};
    points_ = {all(0), low_y_, zero};
    return;
  }
  const Floats t = reach / width * all(0.99999f);
  Floats in, out;
  enter(room(), in, out);
  // Beams that may leave the field about there start at the sensor, in 64 bits.
  const Mask goes = without(both(at_least(end_, zero), at_least(smaller(end_, out), t)), ends);
  const Mask unsure = both(goes, greater(t, inside_));
  start(points_at(select(unsure, zero, smaller(t, end_))), without(goes, unsure), level);
  found_.unsure = unsure;
}

CellHeights Search::cell_at(const Ints& x, const Ints& y, const Floats& place_x, const Floats& place_y) const {
  const Ints row = (y - low_y_) * all(field_->columns) + x;
  const float* const heights = field_->heights.data();
  const Floats side = all(side_), z = all(z_);
  Floats a, b, d, e;
  gather_pairs(heights, row, a, b), gather_pairs(heights + field_->columns, row, d, e);
  a = mulsub(a, side, z), b = mulsub(b, side, z), d = mulsub(d, side, z), e = mulsub(e, side, z);
  return {a, b - a, d - a, e - a, place_x, place_y};
}

/// Returns whether beams that sink from `high` to `low` between two points certainly meet the triangle between these,
/// away from its edges. @param upper set to that triangle
Mask Search::certain(const CellHeights& cell, const Floats& from, const Floats& to, const Floats& high,
                     const Floats& low, const Floats& error, Mask& upper) const {
  const Floats sunk = high - low, length = to - from, t = muladd(length, high / sunk, from);
  const Floats x = muladd(t, dx_, cell.x), y = muladd(t, dy_, cell.y), one = all(1.0f);
  const Floats inside = smaller(smaller(smaller(x, one - x), smaller(y, one - y)), absolute(x - y));
  const Floats speed = absolute(dx_) + absolute(dy_);
  const Mask sure = greater(inside, muladd(speed * error, length / sunk, place_error(to)));
  const Mask above = greater(y, x);
  upper = either(both(sure, above), without(upper, sure));
  return sure;
}

Crossing Search::crossing() const {
  const Ints origin_x = this->origin_x(), origin_y = this->origin_y();
  Crossing at;
  at.low_x = points_.x >> level_ << level_, at.low_y = points_.y >> level_ << level_;
  at.line_x = smaller(at.low_x + (step_x_ << level_), cells_x_);
  at.line_y = smaller(at.low_y + (step_y_ << level_), end_y_);
  at.x = from_x_ - floats_of(at.low_x - origin_x), at.y = from_y_ - floats_of(at.low_y - origin_y);
  const Floats out_x = (floats_of(at.line_x - origin_x) - from_x_) * per_x_;
  const Floats out_y = (floats_of(at.line_y - origin_y) - from_y_) * per_y_;
  at.through_x = at_least(out_y, out_x);
  at.out = larger(smaller(out_x, out_y), points_.t);
  return at;
}

/// Moves each beam past its block or its cell, or one level down, or ends it.
void Search::step() {
  const Mask moving = both(active_, greater(level_, all(0)));
  if (none(moving))
    step_cells();
  else
    step_blocks(moving);
}

void Search::step_blocks(const Mask& moving) {
  const Crossing at = crossing();
  const Ints level = larger(level_, all(1));  // some beams wait at their cells
  const Ints row = (points_.y >> level) * all(field_->pitch) + (points_.x >> level);
  Floats height, slopes;
  gather_pairs<2>(&planes_->height, row, height, slopes);
  const Ints packed = bits_of_floats(slopes);
  const Floats slope_x = floats_of(packed << all(16)), slope_y = floats_of(packed & all(~0xFFFF));
  // The beam's height above the plane is t rise - under, less twice the error, so that cells tell it from 0.
  const Floats level_plane = muladd(all(plane_error_per_metre_), at.out, height - all(plane_z_));
  const Floats under = muladd(all(slope_unit_), muladd(slope_x, at.x, slope_y * at.y), level_plane);
  const Floats rise = mulless(slope_x, tilt_x_, mulless(slope_y, tilt_y_, dz_));
  const Floats now = mulsub(points_.t, rise, under), then = mulsub(at.out, rise, under), room = smaller(now, then);
  const Mask clear = greater(room, all(0.0f));
  const Floats meets = select_or_zero(greater(now, all(0.0f)), under / rise * all(0.999999f));
  move(at, moving, clear, select(clear, at.out, smaller(larger(meets, points_.t), at.out)), room);
}

void Search::step_cells() {
  const Crossing at = crossing();
  const Floats t = points_.t, error = error_at(at.out), below = all(0.0f) - error;
  const CellHeights cell = cell_at(points_.x, points_.y, at.x, at.y);
  const Floats diagonal = smaller(larger((at.y - at.x) * per_turn_, t), at.out);
  const Floats first = cell.above(diagonal, dx_, dy_, dz_), second = cell.above(at.out, dx_, dy_, dz_);
  const Mask over_first = greater(first, error), passes = both(over_first, greater(second, error));
  const Mask in_first = greater(below, first);
  const Mask moving = active_, stop = without(moving, passes);
  if (!none(stop)) {
    const Floats from = select(in_first, t, diagonal), to = select(in_first, diagonal, at.out);
    const Floats high = select(in_first, cell.above(t, dx_, dy_, dz_), first), low = select(in_first, first, second);
    Mask hit =
        both(both(stop, inner(points_.x, points_.y)), either(in_first, both(over_first, greater(below, second))));
    hit = both(hit, certain(cell, from, to, high, low, error, found_.upper));
    found_.sure = either(found_.sure, hit), found_.unsure = either(found_.unsure, without(stop, hit));
    active_ = without(active_, stop);
  }
  move(at, both(moving, passes), passes, at.out, smaller(first, second) - error);
}

/// @param moving beams that go on  @param clear those that pass, to `next`; others try a smaller block from there
/// @param room [m] height above the surface up to there
void Search::move(const Crossing& at, const Mask& moving, const Mask& clear, const Floats& next, const Floats& room) {
  const Ints one = all(1), size = one << level_;
  const Ints high_x = smaller(at.low_x + size, cells_x_) - one, high_y = smaller(at.low_y + size, end_y_) - one;
  const Ints place_x = smaller(larger(x_at(next), at.low_x), high_x);
  const Ints place_y = smaller(larger(y_at(next), at.low_y), high_y);
  const Mask cross_x = both(clear, at.through_x), cross_y = without(clear, at.through_x);
  const Ints next_x = select(cross_x, at.line_x + step_x_ - one, place_x);
  const Ints next_y = select(cross_y, at.line_y + step_y_ - one, place_y);
  const Ints parity = select(at.through_x, at.line_x, at.line_y) >> level_ & one;
  const Ints level = select(clear, smaller(level_ + one - parity, all(field_->levels)), level_ - one);

  const Mask beyond = both(moving, greater(next, inside_));
  if (!none(beyond)) end(at, both(beyond, clear), next_x, next_y, room);
  const Mask goes = both(moving, active_);
  points_ = {select(goes, next_x, points_.x), select(goes, next_y, points_.y), select(goes, next, points_.t)};
  level_ = select(goes, level, level_);
  if (!none(beyond)) active_ = both(active_, at_least(end_, points_.t));
}

/// Ends beams that leave the field at the next cell.
void Search::end(const Crossing& at, const Mask& crossing, const Ints& x, const Ints& y, const Floats& room) {
  const Mask outside = either(either(greater(all(0), x), greater(x, cells_x_ - all(1))),
                              either(greater(low_y_, y), greater(y, end_y_ - all(1))));
  const Mask left = both(crossing, outside);
  if (none(left)) return;
  // Beams along the border may stay inside.
  const Floats speed = absolute(select(at.through_x, dx_, dy_));
  const Floats rate = muladd(all(field_->steepest), absolute(dx_) + absolute(dy_), absolute(dz_));
  found_.unsure = either(found_.unsure, without(left, greater(room * speed, rate * place_error(at.out))));
  active_ = without(active_, left);
}

}  // namespace sf::scene::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
