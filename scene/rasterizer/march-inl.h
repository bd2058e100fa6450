// Walks the beams of a vector over a height field, from block to block of its pyramid, to the cells where they meet it.
// Compiled once per instruction set (hwy/foreach_target.h). Bounds of errors: field_view.h.

#if defined(SF_SCENE_MARCH_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SF_SCENE_MARCH_INL_H
#undef SF_SCENE_MARCH_INL_H
#else
#define SF_SCENE_MARCH_INL_H
#endif

#include "scene/horizon.h"
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
  HWY_INLINE Search(const FieldView& view, const FieldRays& rays, float side, const Floats& end);
  /// Starts from points before which the beams certainly do not meet the field.
  HWY_INLINE void start(const FieldPoints& points, const Mask& active, const Ints& level) {
    const Mask no = greater(all(0.0f), all(0.0f));
    points_ = points, active_ = active, found_ = {no, no, no};
    level_ = smaller(level, all(field_->levels));
    per_x_ = reciprocal(dx_), per_y_ = reciprocal(dy_), per_turn_ = reciprocal(dx_ - dy_);
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
  /// Largest integer up to v, or its neighbour where rounding decides; |v| < 2^22.
  HWY_INLINE Ints floor_near(const Floats& v) const {
    return bits_of_floats(v - all(0.5f) + all(0x1.8p23f)) - all(0x4B400000);
  }
  HWY_INLINE Ints x_at(const Floats& t) const { return floor_near(muladd(t, dx_, from_x_)) + origin_x(); }
  HWY_INLINE Ints y_at(const Floats& t) const { return floor_near(muladd(t, dy_, from_y_)) + origin_y(); }

  const FieldView* view_ = nullptr;
  const HeightField* field_ = nullptr;
  float side_ = 1.0f, z_ = 0.0f;
  const BoundingPlane* planes_ = nullptr;
  Floats dx_, dy_, dz_, per_x_, per_y_, per_turn_, end_, from_x_, from_y_, error_, error_per_metre_;
  Ints step_x_, step_y_, cells_x_, low_y_, end_y_;

  FieldPoints points_;
  Ints level_;  ///< of the blocks that come next; 0: cells
  Mask active_;
  Found found_;
};

/// Loads pairs of floats from from[row] and from[row + 1].
HWY_INLINE void gather_pairs(const float* from, const Ints& rows, Floats& first, Floats& second) {
#if HWY_TARGET == HWY_SCALAR
  first = gather(from, rows), second = gather(from + 1, rows);
#else
  constexpr hn::CappedTag<std::uint64_t, kLanes / 2> kPair;
  constexpr hn::RebindToSigned<decltype(kPair)> kOffset;
  constexpr hn::Rebind<std::int32_t, decltype(kPair)> kHalf;
  const auto* const pairs = reinterpret_cast<const std::uint64_t*>(from);
  for (std::size_t p = 0; p < kParts; ++p) {
    const auto low = hn::ShiftLeft<2>(hn::PromoteTo(kOffset, hn::LowerHalf(kHalf, rows.part[p])));
    const auto high = hn::ShiftLeft<2>(hn::PromoteTo(kOffset, hn::UpperHalf(kHalf, rows.part[p])));
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

Search::Search(const FieldView& view, const FieldRays& rays, float side, const Floats& end)
    : view_(&view), field_(view.field), side_(side), z_(static_cast<float>(view.z * side)), end_(end) {
  planes_ = (side > 0.0f ? field_->above : field_->below).data() +
            static_cast<std::ptrdiff_t>(field_->bias / 2) * field_->pitch;
  dx_ = as_floats(rays.x, 1.0), dy_ = as_floats(rays.y, 1.0), dz_ = as_floats(rays.z, side);
  const Floats zero = all(0.0f);
  from_x_ = all(static_cast<float>(view.from.x)), from_y_ = all(static_cast<float>(view.from.y));
  step_x_ = select(at_least(dx_, zero), all(1), all(0)), step_y_ = select(at_least(dy_, zero), all(1), all(0));
  cells_x_ = all(field_->columns - 1), low_y_ = all(-field_->bias), end_y_ = all(field_->rows - 1 - field_->bias);
  error_ = all(view.error32), error_per_metre_ = all(view.error32_per_metre);
}

void Search::enter(const Floats& room, Floats& in, Floats& out) const {
  const auto along = [&](std::int32_t base, std::int32_t cells, const Floats& from, const Floats& inverse) {
    const Floats low = (all(static_cast<float>(-base)) - from - room) * inverse;
    const Floats high = (all(static_cast<float>(cells - base)) - from + room) * inverse;
    in = larger(in, smaller(low, high)), out = smaller(out, larger(low, high));
  };
  in = all(0.0f), out = end_;
  along(view_->base.x, field_->columns - 1, from_x_, reciprocal(dx_));
  along(view_->base.y, field_->rows - 1, from_y_, reciprocal(dy_));
}

void Search::start(const Horizon& horizon) {
  constexpr std::int32_t kRound = Horizon::kSectors;
  const Floats x = dx_ * all(static_cast<float>(field_->cell.x)), y = dy_ * all(static_cast<float>(field_->cell.y));
  const Floats zero = all(0.0f), width = absolute(x) + absolute(y), flat = root(muladd(x, x, y * y));
  const Floats part = y / larger(width, all(1e-30f)), turn = select(at_least(x, zero), part, all(2.0f) - part);
  const Floats sector = muladd(turn, all(0.25f * kRound), all(0.25f * kRound));
  auto first = static_cast<std::int32_t>(least(sector) - 0.001f + kRound) - kRound;
  auto last = static_cast<std::int32_t>(0.001f - least(zero - sector));
  if (last - first > kRound / 2) {  // on both sides of the first sector
    const Floats turned = select(greater(sector, all(0.5f * kRound)), sector - all(1.0f * kRound), sector);
    first = static_cast<std::int32_t>(least(turned) - 0.001f + kRound) - kRound;
    last = static_cast<std::int32_t>(0.001f - least(zero - turned) + kRound) - kRound;
  }
  const Floats slope = dz_ / larger(flat, all(1e-30f)), sure = slope - muladd(absolute(slope), all(1e-6f), all(1e-6f));
  Floats reach = zero;
  Ints level = all(1);
  for (std::int32_t k = 0; k < horizon.rings; ++k) {
    float most = -HUGE_VALF;
    for (std::int32_t s = first; s <= last; ++s) most = std::max(most, horizon.slope[(s + kRound) % kRound][k]);
    const Mask over = greater(sure, all(most));
    if (none(over)) break;
    reach = select(over, all(horizon.reach[k]), reach), level = select(over, all(horizon.level[k]), level);
  }
  const Mask ends = at_least(reach, all(horizon.reach[horizon.rings - 1]));
  if (none(without(at_least(end_, zero), ends))) {  // all beams stay above the ground
    const Mask no = greater(zero, zero);
    active_ = no, found_ = {no, no, no};
    points_ = {all(0), low_y_, zero};
    return;
  }
  const Floats t = reach / larger(flat, all(1e-30f)) * all(0.999999f);
  Floats in, inside, out;
  enter(zero - room(), in, inside), enter(room(), in, out);
  // Beams that may leave the field about there start at the sensor, in 64 bits.
  const Mask goes = without(both(at_least(end_, zero), at_least(smaller(end_, out), t)), ends);
  const Mask unsure = both(goes, greater(t, inside));
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
  gather_pairs(&planes_->height, row + row, height, slopes);
  const Ints packed = bits_of_floats(slopes), half = all(16);
  const Floats unit = all(field_->slope_unit);
  const Floats slope_x = floats_of(packed << half >> half) * unit, slope_y = floats_of(packed >> half) * unit;
  // The beam's height above the plane is t rise - under, less twice the error, so that cells tell it from 0.
  const Floats under = muladd(slope_x, at.x, muladd(slope_y, at.y, height - all(z_))) + all(2.0f) * error_at(at.out);
  const Floats rise = dz_ - muladd(slope_x, dx_, slope_y * dy_);
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
  const Ints one = all(1), zero = all(0), size = one << level_;
  const Ints high_x = smaller(at.low_x + size, cells_x_) - one, high_y = smaller(at.low_y + size, end_y_) - one;
  const Ints place_x = smaller(larger(x_at(next), at.low_x), high_x);
  const Ints place_y = smaller(larger(y_at(next), at.low_y), high_y);
  const Mask cross_x = both(clear, at.through_x), cross_y = without(clear, at.through_x);
  const Ints next_x = select(cross_x, at.line_x + step_x_ - one, place_x);
  const Ints next_y = select(cross_y, at.line_y + step_y_ - one, place_y);
  const Ints parity = select(at.through_x, at.line_x, at.line_y) >> level_ & one;
  const Ints level = select(clear, smaller(level_ + one - parity, all(field_->levels)), level_ - one);

  const Mask outside = either(either(greater(zero, next_x), greater(next_x, cells_x_ - one)),
                              either(greater(low_y_, next_y), greater(next_y, end_y_ - one)));
  const Mask left = both(both(moving, clear), outside);
  if (!none(left)) {  // beams along the border may stay inside
    const Floats speed = absolute(select(at.through_x, dx_, dy_));
    const Floats rate = muladd(all(field_->steepest), absolute(dx_) + absolute(dy_), absolute(dz_));
    found_.unsure = either(found_.unsure, without(left, greater(room * speed, rate * place_error(at.out))));
    active_ = without(active_, left);
  }
  const Mask goes = both(moving, active_);
  points_ = {select(goes, next_x, points_.x), select(goes, next_y, points_.y), select(goes, next, points_.t)};
  level_ = select(goes, level, level_);
  active_ = both(active_, at_least(end_, points_.t));
}

/// The marching of one vector's beams: searches in 32 bits, then decisions and ranges in 64.
class Marching {
 public:
  /// @param end [m] where the search of each beam ends, at the latest
  /// @param horizon of a sensor above the field
  void begin(const FieldView& view, const Horizon& horizon, const BeamTile& tile, std::uint32_t first,
             const Floats& end);
  /// @return whether a search goes on
  HWY_INLINE bool step() {
    bool more = false;
    for (int k = 0; k < searches_; ++k)
      if (!search_[k].done()) search_[k].step(), more = true;
    return more;
  }
  /// Shortens ranges to the field. @return bit mask of beams that got a flag
  std::uint32_t finish(double* ranges, std::uint32_t* hits, ScanCounts& counts);
  /// Beams whose ranges `finish` shortened.
  std::uint32_t met() const { return met_; }
  /// Unit normal in the field's frame, upward, of such a beam's triangle.
  glm::dvec3 normal(std::uint32_t i) const {
    const FieldPlane plane = view_->plane_of({{x_[i], y_[i]}, (upper_ >> i & 1) != 0});
    return glm::normalize(glm::dvec3{-plane.slope.x * view_->per_metre.x, -plane.slope.y * view_->per_metre.y, 1.0});
  }

 private:
  void rotate(const BeamTile& tile, std::uint32_t first);
  void add(const Search& search, const FieldPoints& points, const Mask& active, float side);
  void collect(const Search& search);
  void decide(std::uint32_t beam, double range);
  std::uint32_t evaluate(double* ranges, std::uint32_t* hits);

  const FieldView* view_ = nullptr;
  FieldRays rays_;
  Search search_[2];
  int searches_ = 0;
  alignas(64) std::int32_t x_[kWidth], y_[kWidth];
  alignas(64) float t_[kWidth];
  std::int8_t from_[kWidth];  ///< FieldStart::side at these points; 0: the beam is walked from where it enters
  std::uint32_t sure_ = 0, upper_ = 0, unsure_ = 0, flagged_ = 0, met_ = 0;
};

void Marching::rotate(const BeamTile& tile, std::uint32_t first) {
  const auto row = [&](int k, double scale, double* out) {
    const glm::dmat3& R = view_->X_FS.R;
    const VD x = hn::Set(kD, R[0][k]), y = hn::Set(kD, R[1][k]), z = hn::Set(kD, R[2][k]);
    for (std::size_t i = 0; i < kWidth; i += hn::Lanes(kD)) {
      const VD flat =
          hn::Add(hn::Mul(x, hn::Load(kD, tile.dx + first + i)), hn::Mul(y, hn::Load(kD, tile.dy + first + i)));
      const VD sum = hn::Add(flat, hn::Mul(z, hn::Load(kD, tile.dz + first + i)));
      hn::Store(hn::Mul(sum, hn::Set(kD, scale)), kD, out + i);
    }
  };
  row(0, view_->per_metre.x, rays_.x), row(1, view_->per_metre.y, rays_.y), row(2, 1.0, rays_.z);
}

void Marching::begin(const FieldView& view, const Horizon& horizon, const BeamTile& tile, std::uint32_t first,
                     const Floats& end) {
  view_ = &view, searches_ = 0, sure_ = upper_ = unsure_ = flagged_ = met_ = 0;
  std::fill_n(from_, kWidth, std::int8_t{0});
  rotate(tile, first);
  const Floats zero = all(0.0f);
  if (!view.searchable || view.near) return void(unsure_ = (1u << kWidth) - 1);
  if (view.side != 0) {
    search_[searches_++] = Search(view, rays_, static_cast<float>(view.side), end);
    std::fill_n(from_, kWidth, static_cast<std::int8_t>(view.side));
    if (view.side > 0) return search_[0].start(horizon);
    return search_[0].start(search_[0].points_at(zero), at_least(end, zero), all(kFirstLevel));
  }
  // From outside: where each beam enters the field.
  const Search above(view, rays_, 1.0f, end);
  Floats in, out;
  above.enter(above.room(), in, out);
  const Mask enters = both(at_least(out, in), at_least(end, in));
  if (none(enters)) return;
  const FieldPoints points = above.points_at(in);
  const Floats height = above.above(points), error = above.error_at(in);
  const Mask over = both(enters, greater(height, error)), under = both(enters, greater(zero - error, height));
  add(above, points, over, 1.0f);
  if (!none(under)) add(Search(view, rays_, -1.0f, end), points, under, -1.0f);
  unsure_ = bits_of(without(enters, either(over, under)));
}

void Marching::add(const Search& search, const FieldPoints& points, const Mask& active, float side) {
  search_[searches_] = search;
  search_[searches_++].start(points, active, all(kFirstLevel));
  for (std::uint32_t rest = bits_of(active); rest != 0; rest &= rest - 1)
    from_[__builtin_ctz(rest)] = static_cast<std::int8_t>(side);
}

void Marching::collect(const Search& search) {
  const std::uint32_t sure = bits_of(search.found().sure), unsure = bits_of(search.found().unsure);
  alignas(64) std::int32_t x[kWidth], y[kWidth];
  alignas(64) float t[kWidth];
  store(search.points().x, x), store(search.points().y + all(view_->field->bias), y), store(search.points().t, t);
  for (std::uint32_t rest = sure | unsure; rest != 0; rest &= rest - 1) {
    const auto i = static_cast<std::uint32_t>(__builtin_ctz(rest));
    x_[i] = x[i], y_[i] = y[i], t_[i] = t[i];
  }
  sure_ |= sure, unsure_ |= unsure, upper_ |= bits_of(search.found().upper) & sure;
}

void Marching::decide(std::uint32_t i, double range) {
  const FieldRay ray = rays_.at(i);
  const double end = range * (1.0 + 2e-6);
  const FieldHit hit =
      from_[i] != 0 ? walk(*view_, ray, {{x_[i], y_[i]}, t_[i], from_[i]}, end) : walk(*view_, ray, end);
  if (hit.flagged) flagged_ |= 1u << i;
  if (!hit.found) return;
  sure_ |= 1u << i;
  upper_ = (upper_ & ~(1u << i)) | std::uint32_t{hit.triangle.upper} << i;
  x_[i] = hit.triangle.cell.x, y_[i] = hit.triangle.cell.y;
}

/// Evaluates ranges in 64 bits, in the order of operations of FieldView::plane_of.
std::uint32_t Marching::evaluate(double* ranges, std::uint32_t* hits) {
  // Differences along x and along y of each triangle, and its cell's first corner.
  alignas(64) double corner[kWidth] = {}, x[kWidth] = {}, y[kWidth] = {}, across[2][kWidth] = {}, along[2][kWidth] = {};
  const HeightField& field = *view_->field;
  for (std::uint32_t rest = sure_; rest != 0; rest &= rest - 1) {
    const auto i = static_cast<std::uint32_t>(__builtin_ctz(rest));
    const bool upper = (upper_ >> i & 1) != 0;
    const float* const a = field.heights.data() + field.at(x_[i], y_[i]);
    const float *const row = a + (upper ? field.columns : 0), *const column = a + (upper ? 0 : 1);
    corner[i] = *a, across[0][i] = row[0], across[1][i] = row[1];
    along[0][i] = column[0], along[1][i] = column[field.columns];
    x[i] = x_[i] - view_->base.x, y[i] = y_[i] - view_->base.y;
  }
  alignas(64) double t[kWidth], fall[kWidth];
  const VD from_x = hn::Set(kD, view_->from.x), from_y = hn::Set(kD, view_->from.y), z = hn::Set(kD, view_->z);
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(kD)) {
    const auto at = [i](const double* v) { return hn::Load(kD, v + i); };
    const VD slope_x = hn::Sub(at(across[1]), at(across[0])), slope_y = hn::Sub(at(along[1]), at(along[0]));
    const VD rise = hn::Add(hn::Mul(slope_x, at(rays_.x)), hn::Mul(slope_y, at(rays_.y)));
    const VD place = hn::Add(hn::Mul(slope_x, hn::Sub(from_x, at(x))), hn::Mul(slope_y, hn::Sub(from_y, at(y))));
    const VD sinks = hn::Sub(rise, at(rays_.z));
    hn::Store(hn::Div(hn::Sub(z, hn::Add(at(corner), place)), sinks), kD, t + i);
    hn::Store(hn::Abs(sinks), kD, fall + i);
  }
  const double least_fall = view_->error / kRangeError;
  std::uint32_t flags = flagged_ & ~sure_;
  for (std::uint32_t rest = sure_; rest != 0; rest &= rest - 1) {
    const auto i = static_cast<std::uint32_t>(__builtin_ctz(rest));
    const double range = std::max(t[i], 0.0);
    if (!(range < ranges[i])) continue;
    ranges[i] = range, hits[i] = base::kFloorHit;
    met_ |= 1u << i;
    flags |= (flagged_ & 1u << i) | std::uint32_t{fall[i] < least_fall} << i;
  }
  return flags;
}

std::uint32_t Marching::finish(double* ranges, std::uint32_t* hits, ScanCounts& counts) {
  for (int k = 0; k < searches_; ++k) collect(search_[k]);
  counts.uncertain += static_cast<std::uint64_t>(__builtin_popcount(unsure_));
  for (std::uint32_t rest = unsure_; rest != 0; rest &= rest - 1) {
    const auto i = static_cast<std::uint32_t>(__builtin_ctz(rest));
    decide(i, ranges[i]);
  }
  return (sure_ | flagged_) != 0 ? evaluate(ranges, hits) : 0;
}

}  // namespace sf::scene::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
