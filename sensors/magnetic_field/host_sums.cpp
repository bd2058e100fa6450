#include "sensors/magnetic_field/host_sums.h"

#include <algorithm>

#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sensors/magnetic_field/host_sums.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h: the code below is compiled once per instruction set.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sf::sensors::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// A vector has one point per lane. Magnets are added one by one, so each point's sum has a fixed order.
using D = hn::CappedTag<double, 8>;
using F = hn::Rebind<float, D>;
using V = hn::Vec<D>;
constexpr D kD;
constexpr F kF;

constexpr std::size_t kPadded = 8;  // places in rows of points

/// The points of a group, one row per coordinate.
struct PointRows {
  double x[kPadded], y[kPadded], z[kPadded];
};

struct Sums {
  V x, y, z, magnitudes;
};

HWY_INLINE V number(double value) { return hn::Set(kD, value); }

/// Same as `add` in shaders/lib/dipoles.glsl, term by term.
template <bool kMagnitudes>
HWY_INLINE void add(const DipoleRow& m, V px, V py, V pz, V cutoff_squared, Sums& sum) {
  const V dx = hn::Sub(px, number(m.x));
  const V dy = hn::Sub(py, number(m.y));
  const V dz = hn::Add(hn::Sub(pz, number(m.z)), number(1e-18));
  const V along = hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy));
  const V squared = hn::Add(along, hn::Mul(dz, dz));

  const auto root = hn::Sqrt(hn::Max(hn::DemoteTo(kF, squared), hn::Set(kF, 1e-37F)));
  const V rough = hn::PromoteTo(kD, hn::Div(hn::Set(kF, 1.0F), root));
  const V one = hn::Mul(hn::Mul(squared, rough), rough);
  const V inverse = hn::Mul(rough, hn::Sub(number(1.5), hn::Mul(number(0.5), one)));
  const V limit = number(double{m.inverse_radius});
  const V bounded = hn::IfThenElse(hn::Lt(inverse, limit), inverse, limit);
  V scale = hn::Mul(hn::Mul(number(double{m.moment}), bounded), hn::Mul(bounded, bounded));
  scale = hn::IfThenElseZero(hn::Le(along, cutoff_squared), scale);

  const V uz = hn::Mul(dz, inverse);
  const V c = hn::Mul(hn::Mul(hn::Mul(number(3.0), uz), scale), inverse);
  sum.x = hn::Add(sum.x, hn::Mul(c, dx));
  sum.y = hn::Add(sum.y, hn::Mul(c, dy));
  sum.z = hn::Add(sum.z, hn::Sub(hn::Mul(c, dz), scale));
  if constexpr (kMagnitudes) {
    const V q = hn::Add(number(1.0), hn::Mul(hn::Mul(number(3.0), uz), uz));
    const auto rough_q = hn::Sqrt(hn::DemoteTo(kF, q));
    const V half_over = hn::PromoteTo(kD, hn::Div(hn::Set(kF, 0.5F), rough_q));
    const V s = hn::PromoteTo(kD, rough_q);
    const V shape = hn::Add(s, hn::Mul(hn::Sub(q, hn::Mul(s, s)), half_over));
    sum.magnitudes = hn::Add(sum.magnitudes, hn::Mul(hn::Abs(scale), shape));
  }
}

template <bool kMagnitudes>
void sum_lanes(std::span<const MagnetSpan> spans, std::span<const DipoleRow> dipoles, const PointRows& points,
               double cutoff_squared, std::uint32_t count, std::span<FieldSum> out) {
  const V cutoff = number(cutoff_squared), zero = hn::Zero(kD);
  for (std::size_t first = 0; first < count; first += hn::Lanes(kD)) {
    const V x = hn::LoadU(kD, points.x + first), y = hn::LoadU(kD, points.y + first);
    const V z = hn::LoadU(kD, points.z + first);
    Sums sum{zero, zero, zero, zero};
    for (const MagnetSpan& span : spans)
      for (const DipoleRow& m : dipoles.subspan(span.first, span.end - span.first))
        add<kMagnitudes>(m, x, y, z, cutoff, sum);
    double rows[4][kPadded];
    hn::StoreU(sum.x, kD, rows[0]), hn::StoreU(sum.y, kD, rows[1]);
    hn::StoreU(sum.z, kD, rows[2]), hn::StoreU(sum.magnitudes, kD, rows[3]);
    for (std::size_t k = 0; k < hn::Lanes(kD) && first + k < count; ++k)
      out[first + k] = {rows[0][k], rows[1][k], rows[2][k], rows[3][k]};
  }
}

void sum_group(std::span<const MagnetSpan> spans, std::span<const DipoleRow> dipoles,
               std::span<const FieldPointRow> points, std::uint32_t count, bool magnitudes, std::span<FieldSum> out) {
  PointRows rows;
  for (std::size_t i = 0; i < kPadded; ++i) {
    const FieldPointRow& point = points[std::min<std::size_t>(i, count - 1)];
    rows.x[i] = point.x, rows.y[i] = point.y, rows.z[i] = point.z;
  }
  (magnitudes ? sum_lanes<true> : sum_lanes<false>)(spans, dipoles, rows, points[0].cutoff_squared, count, out);
}

}  // namespace sf::sensors::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sf::sensors {

HWY_EXPORT(sum_group);

void sum_fields(std::span<const MagnetSpan> spans, std::span<const DipoleRow> dipoles,
                std::span<const FieldPointRow> points, std::uint32_t count, bool magnitudes, std::span<FieldSum> out) {
  HWY_DYNAMIC_DISPATCH(sum_group)(spans, dipoles, points, count, magnitudes, out);
}

}  // namespace sf::sensors
#endif
