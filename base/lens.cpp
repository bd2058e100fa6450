#include "base/lens.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/elementary.h"

namespace sf::base {

namespace {

constexpr int kMostSteps = 50;
constexpr int kHomotopySteps = 16;
constexpr int kRaySteps = 256;  // between the principal point and a pixel of the border

/// Radial factor and its derivative by the square of the radius.
struct Radial {
  double factor, slope;
};
Radial radial(std::span<const double> k, double r2) {
  const double above = 1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  const double rise = k[0] + r2 * (2.0 * k[1] + 3.0 * r2 * k[4]);
  if (k.size() < 8) return {above, rise};
  const double below = 1.0 + r2 * (k[5] + r2 * (k[6] + r2 * k[7]));
  const double fall = k[5] + r2 * (2.0 * k[6] + 3.0 * r2 * k[7]);
  return {above / below, (rise - above / below * fall) / below};
}

double fisheye_slope(const Lens& lens, double angle) {
  const auto& k = lens.distortion;
  const double a2 = angle * angle;
  return 1.0 + a2 * (3.0 * k[0] + a2 * (5.0 * k[1] + a2 * (7.0 * k[2] + a2 * 9.0 * k[3])));
}

/// Inverse of a growing function in [0, end], by Newton's method within shrinking bounds.
template <class Value, class Slope>
double inverse(double value, double end, const Value& value_of, const Slope& slope_of) {
  double low = 0.0, high = end, x = std::min(value, end);
  for (int i = 0; i < kMostSteps; ++i) {
    const double error = value_of(x) - value;
    (error > 0.0 ? high : low) = x;
    double next = x - error / slope_of(x);
    if (!(next >= low && next <= high)) next = 0.5 * (low + high);
    if (next == x) break;
    x = next;
  }
  return x;
}

/// Outer edge of a pixel of the border.
double rim(unsigned i, unsigned count) { return i == 0 ? -0.5 : i + 1 == count ? i + 0.5 : i; }

}  // namespace

glm::dvec2 distorted(std::span<const double> k, glm::dvec2 n) {
  const double r2 = n.x * n.x + n.y * n.y;
  const double factor = radial(k, r2).factor;
  return {n.x * factor + 2.0 * k[2] * n.x * n.y + k[3] * (r2 + 2.0 * n.x * n.x),
          n.y * factor + k[2] * (r2 + 2.0 * n.y * n.y) + 2.0 * k[3] * n.x * n.y};
}

DistortionJacobian distortion_jacobian(std::span<const double> k, glm::dvec2 n) {
  const auto [factor, rise] = radial(k, n.x * n.x + n.y * n.y);
  const double slope = 2.0 * rise;
  return {factor + n.x * n.x * slope + 2.0 * k[2] * n.y + 6.0 * k[3] * n.x,
          n.x * n.y * slope + 2.0 * k[2] * n.x + 2.0 * k[3] * n.y,
          factor + n.y * n.y * slope + 6.0 * k[2] * n.y + 2.0 * k[3] * n.x};
}

glm::dvec2 undistorted(std::span<const double> k, glm::dvec2 bent, glm::dvec2 n) {
  double least = HUGE_VAL;
  for (int i = 0; i < kMostSteps; ++i) {
    const glm::dvec2 error = distorted(k, n) - bent;
    const double size = std::abs(error.x) + std::abs(error.y);
    if (size == 0.0 || (size < 1e-13 && size >= least)) break;  // rounding alone
    least = std::min(least, size);
    const DistortionJacobian j = distortion_jacobian(k, n);
    const double det = j.xx * j.yy - j.xy * j.xy;
    n -= glm::dvec2{j.yy * error.x - j.xy * error.y, j.xx * error.y - j.xy * error.x} / det;
  }
  return n;
}

double fisheye_radius(const Lens& lens, double angle) {
  const auto& k = lens.distortion;
  const double a2 = angle * angle;
  return angle * (1.0 + a2 * (k[0] + a2 * (k[1] + a2 * (k[2] + a2 * k[3]))));
}

glm::dvec2 pixel_of(const Lens& lens, glm::dvec2 n) {
  if (!lens.fisheye) return lens.center + lens.focal * distorted(lens.distortion, n);
  const double r = hypot(n.x, n.y);
  return lens.center + lens.focal * (r > 0.0 ? n * (fisheye_radius(lens, atan(r)) / r) : n);
}

LensImage::LensImage(const Lens& lens, unsigned width, unsigned height) : lens_(lens), width_(width), height_(height) {
  constexpr int kAngles = 4096;
  for (int i = 1; i <= kAngles; ++i) {
    const double angle = kWidestFisheye * i / kAngles;
    if (!(fisheye_slope(lens, angle) > 0.0)) break;
    widest_ = angle;
  }
  rim_ = fisheye_radius(lens, widest_);
}

std::optional<glm::dvec2> LensImage::direction(glm::dvec2 pixel) const {
  const glm::dvec2 bent = (pixel - lens_.center) / lens_.focal;
  if (!lens_.fisheye) {
    glm::dvec2 n = undistorted(lens_.distortion, bent, bent);
    if (is_image_of(bent, n)) return n;
    n = {};  // step by step from the axis, near which the distortion is weak
    for (int i = 1; i <= kHomotopySteps; ++i)
      n = undistorted(lens_.distortion, bent * (static_cast<double>(i) / kHomotopySteps), n);
    return n;
  }
  const double radius = hypot(bent.x, bent.y);
  if (radius == 0.0) return glm::dvec2{};
  if (radius > rim_) return std::nullopt;
  const double angle = inverse(
      radius, widest_, [&](double a) { return fisheye_radius(lens_, a); },
      [&](double a) { return fisheye_slope(lens_, a); });
  return bent * (tan(angle) / radius);
}

bool LensImage::is_image_of(glm::dvec2 bent, glm::dvec2 n) const {
  return glm::distance(distorted(lens_.distortion, n), bent) < 1e-9 &&
         distortion_jacobian(lens_.distortion, n).is_positive();
}

/// Along the line from the axis to the pixel's direction, the distortion must be invertible.
bool LensImage::folds(glm::dvec2 pixel) const {
  if (lens_.fisheye) {
    const glm::dvec2 bent = (pixel - lens_.center) / lens_.focal;
    return widest_ < kWidestFisheye && hypot(bent.x, bent.y) > rim_;
  }
  const glm::dvec2 n = *direction(pixel);
  if (!is_image_of((pixel - lens_.center) / lens_.focal, n)) return true;
  for (int i = 0; i <= kRaySteps; ++i)
    if (!distortion_jacobian(lens_.distortion, n * (static_cast<double>(i) / kRaySteps)).is_positive()) return true;
  return false;
}

std::optional<glm::uvec2> LensImage::fold() const {
  // Lines to the border cross all other pixels.
  for (unsigned v = 0; v < height_; ++v)
    for (unsigned u = 0; u < width_; u += v == 0 || v + 1 == height_ ? 1 : std::max(1u, width_ - 1))
      if (folds({rim(u, width_), rim(v, height_)})) return glm::uvec2{u, v};
  return std::nullopt;
}

}  // namespace sf::base
