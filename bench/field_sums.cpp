// Compiled twice with different SF_SUM, see field_sums.h.

#include "bench/field_sums.h"

#include <cmath>

namespace sf::bench {

namespace {

/// Independent sums, which the compiler can vectorize without reordering additions.
constexpr std::size_t kLanes = 8;
constexpr double kSteps[kLanes] = {0, 1, 2, 3, 4, 5, 6, 7};

struct Sums {
  double x[kLanes] = {}, y[kLanes] = {}, z[kLanes] = {};
};

double total(const double (&lanes)[kLanes]) {
  double sum = 0.0;
  for (const double lane : lanes) sum += lane;
  return sum;
}

/// Same arithmetic as shaders/lib/dipoles.glsl. All loads precede all selections, so that selections do not become
/// branches.
inline void add(const MagnetColumns& m, std::size_t at, double last, double px, double py, double pz,
                double cutoff_squared, Sums& sums) {
  const double* const mx = m.x.data() + at;
  const double* const my = m.y.data() + at;
  const double* const mz = m.z.data() + at;
  const double* const moments = m.moment.data() + at;
  const double* const radii = m.inverse_radius.data() + at;
  for (std::size_t k = 0; k < kLanes; ++k) {
    const double moment = moments[k];
    const double nearest = radii[k];
    const double dx = px - mx[k];
    const double dy = py - my[k];
    const double dz = (pz - mz[k]) + 1e-18;
    const double along = dx * dx + dy * dy;
    const double squared = along + dz * dz;
    const float rounded = static_cast<float>(squared);
    const double rough = static_cast<double>(1.0f / std::sqrt(rounded > 1e-37f ? rounded : 1e-37f));
    const double inverse = rough * (1.5 - 0.5 * (squared * rough * rough));
    const double bounded = inverse < nearest ? inverse : nearest;
    const double whole = moment * bounded * (bounded * bounded);
    const double near = along <= cutoff_squared ? whole : 0.0;
    const double scale = kSteps[k] < last ? near : 0.0;
    const double c = 3.0 * (dz * inverse) * scale * inverse;
    sums.x[k] += c * dx;
    sums.y[k] += c * dy;
    sums.z[k] += c * dz - scale;
  }
}

}  // namespace

FieldVector SF_SUM(const MagnetColumns& magnets, std::span<const sensors::MagnetSpan> spans, double x, double y,
                   double z) {
  const double cutoff_squared = magnets.cutoff > 0.0 ? magnets.cutoff * magnets.cutoff : 1e300;
  Sums sums;
  for (const sensors::MagnetSpan& span : spans)
    for (std::size_t at = span.first; at < span.end; at += kLanes)
      add(magnets, at, static_cast<double>(span.end - at), x, y, z, cutoff_squared, sums);
  return {1e-7 * total(sums.x), 1e-7 * total(sums.y), 1e-7 * total(sums.z)};
}

}  // namespace sf::bench
