// Decides in 64 bits where a vector's beams meet a height field, and measures their ranges, after the search in 32 bits
// (search-inl.h). Compiled once per instruction set (hwy/foreach_target.h). Bounds of errors: field_view.h.

#if defined(SF_SCENE_MARCH_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SF_SCENE_MARCH_INL_H
#undef SF_SCENE_MARCH_INL_H
#else
#define SF_SCENE_MARCH_INL_H
#endif

#include "scene/rasterizer/search-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sf::scene::HWY_NAMESPACE {

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
  store(all(0), x_), store(all(0), y_);
  rotate(tile, first);
  const Floats zero = all(0.0f);
  if (!view.searchable || view.near) return void(unsure_ = (1u << kWidth) - 1);
  if (view.side != 0) {
    search_[searches_++].begin(view, rays_, static_cast<float>(view.side), end);
    std::fill_n(from_, kWidth, static_cast<std::int8_t>(view.side));
    if (view.side > 0) return search_[0].start(horizon);
    return search_[0].start(search_[0].points_at(zero), at_least(end, zero), all(kFirstLevel));
  }
  // From outside: where each beam enters the field.
  Search above;
  above.begin(view, rays_, 1.0f, end);
  Floats in, out;
  above.enter(above.room(), in, out);
  const Mask enters = both(at_least(out, in), at_least(end, in));
  if (none(enters)) return;
  const FieldPoints points = above.points_at(in);
  const Floats height = above.above(points), error = above.error_at(in);
  const Mask over = both(enters, greater(height, error)), under = both(enters, greater(zero - error, height));
  add(above, points, over, 1.0f);
  if (!none(under)) {
    Search below;
    below.begin(view, rays_, -1.0f, end);
    add(below, points, under, -1.0f);
  }
  unsure_ = bits_of(without(enters, either(over, under)));
}

void Marching::add(const Search& search, const FieldPoints& points, const Mask& active, float side) {
  search_[searches_] = search;
  search_[searches_++].start(points, active, all(kFirstLevel));
  for (std::uint32_t rest = bits_of(active); rest != 0; rest &= rest - 1)
    from_[__builtin_ctz(rest)] = static_cast<std::int8_t>(side);
}

void Marching::collect(const Search& search) {
  const Found& found = search.found();
  const Mask known = either(found.sure, found.unsure);
  const FieldPoints& at = search.points();
  store(select(known, at.x, load(x_)), x_);
  store(select(known, at.y + all(view_->field->bias), load(y_)), y_);
  store(select(known, at.t, load(t_)), t_);
  const std::uint32_t sure = bits_of(found.sure);
  sure_ |= sure, unsure_ |= bits_of(found.unsure), upper_ |= bits_of(found.upper) & sure;
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
  const HeightField& field = *view_->field;
  const Ints x = load(x_), y = load(y_), row = y * all(field.columns) + x;
  Floats a, b, d, e;
  gather_pairs(field.heights.data(), row, a, b), gather_pairs(field.heights.data() + field.columns, row, d, e);
  const Mask upper = mask_of(upper_);
  // Differences along x and along y of each triangle, and its cell's first corner.
  alignas(64) float corner[kWidth], across[2][kWidth], along[2][kWidth];
  alignas(64) std::int32_t cell_x[kWidth], cell_y[kWidth];
  store(a, corner), store(select(upper, d, a), across[0]), store(select(upper, e, b), across[1]);
  store(select(upper, a, b), along[0]), store(select(upper, d, e), along[1]);
  store(x - all(view_->base.x), cell_x), store(y - all(view_->base.y), cell_y);
  constexpr hn::Rebind<float, decltype(kD)> kHalf;
  constexpr hn::Rebind<std::int32_t, decltype(kD)> kHalfInts;
  const VD from_x = hn::Set(kD, view_->from.x), from_y = hn::Set(kD, view_->from.y), z = hn::Set(kD, view_->z);
  const VD least_fall = hn::Set(kD, view_->error / kRangeError), zero = hn::Zero(kD);
  std::uint32_t met = 0, shallow = 0;
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(kD)) {
    const auto at = [i](const double* v) { return hn::Load(kD, v + i); };
    const auto height = [i](const float* v) { return hn::PromoteTo(kD, hn::Load(kHalf, v + i)); };
    const auto place = [i](const std::int32_t* v) { return hn::PromoteTo(kD, hn::Load(kHalfInts, v + i)); };
    const VD slope_x = hn::Sub(height(across[1]), height(across[0])),
             slope_y = hn::Sub(height(along[1]), height(along[0]));
    const VD rise = hn::Add(hn::Mul(slope_x, at(rays_.x)), hn::Mul(slope_y, at(rays_.y)));
    const VD under =
        hn::Add(hn::Mul(slope_x, hn::Sub(from_x, place(cell_x))), hn::Mul(slope_y, hn::Sub(from_y, place(cell_y))));
    const VD sinks = hn::Sub(rise, at(rays_.z));
    const VD t = hn::Div(hn::Sub(z, hn::Add(height(corner), under)), sinks);
    const VD range = hn::IfThenElse(t < zero, zero, t), before = at(ranges);
    const auto nearer = hn::And(range < before, hn::LoadMaskBits(kD, bytes_of(sure_ >> i).data()));
    hn::Store(hn::IfThenElse(nearer, range, before), kD, ranges + i);
    met |= double_bits_of(nearer) << i, shallow |= double_bits_of(hn::Abs(sinks) < least_fall) << i;
  }
  met_ = met;
  store(select(mask_of(met), all(base::kFloorHit), load(hits)), hits);
  return (flagged_ & ~sure_) | (met & (flagged_ | shallow));
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
