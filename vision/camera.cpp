#include "vision/camera.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/elementary.h"
#include "base/pose.h"

namespace sf::vision {

namespace {

constexpr double kMaxTangent = 5.67;  // of 80 degrees
constexpr double kMaxDepth = 1e3;     // [m]

/// Returns distorted normalised coordinates.
glm::dvec2 bend(const std::array<double, 5>& d, glm::dvec2 n) {
  const double r2 = n.x * n.x + n.y * n.y;
  const double radial = 1.0 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]));
  return {n.x * radial + 2.0 * d[2] * n.x * n.y + d[3] * (r2 + 2.0 * n.x * n.x),
          n.y * radial + d[2] * (r2 + 2.0 * n.y * n.y) + 2.0 * d[3] * n.x * n.y};
}

/// Columns of the Jacobian of `bend`, which is symmetric: d/dx = (xx, xy), d/dy = (xy, yy).
struct Jacobian {
  double xx, xy, yy;
};
Jacobian jacobian(const std::array<double, 5>& d, glm::dvec2 n) {
  const double r2 = n.x * n.x + n.y * n.y;
  const double radial = 1.0 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]));
  const double slope = 2.0 * (d[0] + r2 * (2.0 * d[1] + 3.0 * r2 * d[4]));
  return {radial + n.x * n.x * slope + 2.0 * d[2] * n.y + 6.0 * d[3] * n.x,
          n.x * n.y * slope + 2.0 * d[2] * n.x + 2.0 * d[3] * n.y,
          radial + n.y * n.y * slope + 6.0 * d[2] * n.y + 2.0 * d[3] * n.x};
}

}  // namespace

bool is_camera_name(std::string_view name) {
  const auto is_plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
  };
  return !name.empty() && name.size() <= 64 && is_plain(name[0]) &&
         std::all_of(name.begin(), name.end(), [&](char c) { return is_plain(c) || c == '_' || c == '-'; });
}

glm::dvec2 distort(const Intrinsics& intrinsics, glm::dvec2 normalised) {
  return intrinsics.center + intrinsics.focal * bend(intrinsics.distortion, normalised);
}

glm::dvec2 undistort(const Intrinsics& intrinsics, glm::dvec2 pixel) {
  const glm::dvec2 bent = (pixel - intrinsics.center) / intrinsics.focal;
  glm::dvec2 n = bent;
  for (int i = 0; i < 20; ++i) {
    const glm::dvec2 error = bend(intrinsics.distortion, n) - bent;
    if (std::abs(error.x) + std::abs(error.y) < 1e-13) break;
    const Jacobian j = jacobian(intrinsics.distortion, n);
    const double det = j.xx * j.yy - j.xy * j.xy;
    n -= glm::dvec2{j.yy * error.x - j.xy * error.y, j.xx * error.y - j.xy * error.x} / det;
  }
  return n;
}

bool is_invertible(const Intrinsics& intrinsics) {
  // Along rays of growing field angle from the principal point, the Jacobian must be positive definite until the ray
  // leaves the image.
  constexpr int kRays = 64;
  constexpr int kSteps = 2000;
  for (int ray = 0; ray < kRays; ++ray) {
    const double angle = 2.0 * M_PI * ray / kRays;
    bool outside = false;
    for (int step = 0; step <= kSteps && !outside; ++step) {
      const double tangent = kMaxTangent * step / kSteps;
      const glm::dvec2 n = tangent * base::direction(angle);
      const Jacobian j = jacobian(intrinsics.distortion, n);
      if (!(j.xx > 0.0) || !(j.xx * j.yy - j.xy * j.xy > 0.0)) return false;
      const glm::dvec2 pixel = distort(intrinsics, n);
      const glm::dvec2 margin = 0.05 * glm::dvec2{intrinsics.width, intrinsics.height};
      outside = pixel.x < -margin.x || pixel.y < -margin.y || pixel.x > intrinsics.width - 1 + margin.x ||
                pixel.y > intrinsics.height - 1 + margin.y;
    }
    if (!outside) return false;
  }
  return true;
}

std::optional<glm::dvec2> project(const Camera& camera, glm::dvec3 p_W) {
  const glm::dvec3 p = p_W - camera.position;
  const double depth = glm::dot(camera.forward, p);
  if (!(depth > 1e-6)) return std::nullopt;
  const glm::dvec2 n = glm::dvec2{glm::dot(camera.right, p), glm::dot(camera.down, p)} / depth;
  if (!(glm::dot(n, n) < kMaxTangent * kMaxTangent)) return std::nullopt;
  const glm::dvec2 pixel = distort(camera.intrinsics, n);
  // Outside of the image, strong distortion may fold back into it.
  if (glm::distance(undistort(camera.intrinsics, pixel), n) > 1e-6) return std::nullopt;
  return pixel;
}

std::optional<glm::dvec2> meet_plane(const Camera& camera, glm::dvec2 n, double z) {
  const glm::dvec3 ray = n.x * camera.right + n.y * camera.down + camera.forward;
  const double depth = (z - camera.position.z) / ray.z;
  if (!(depth > 1e-6) || !(depth < kMaxDepth)) return std::nullopt;
  return glm::dvec2{camera.position.x + depth * ray.x, camera.position.y + depth * ray.y};
}

std::optional<glm::dvec2> to_plane(const Camera& camera, glm::dvec2 pixel, double z) {
  return meet_plane(camera, undistort(camera.intrinsics, pixel), z);
}

double middle_of_exposure(const Camera& camera, double v) {
  return 0.5 * camera.exposure + camera.readout * v / std::max(1, camera.intrinsics.height - 1);
}

void set_orientation(Camera& camera, const std::array<double, 4>& xyzw) {
  const auto [x, y, z, w] = xyzw;
  camera.right = {1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w)};
  camera.down = {2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w)};
  camera.forward = {2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y)};
}

std::array<double, 4> orientation(const Camera& camera) {
  // Compute the largest of the four components first, to avoid division by a small number.
  const glm::dvec3 &a = camera.right, &b = camera.down, &c = camera.forward;
  const std::array<double, 4> squares{1.0 + a.x - b.y - c.z, 1.0 - a.x + b.y - c.z, 1.0 - a.x - b.y + c.z,
                                      1.0 + a.x + b.y + c.z};
  const auto largest = std::max_element(squares.begin(), squares.end()) - squares.begin();
  const double half = 0.5 * std::sqrt(squares[static_cast<std::size_t>(largest)]);
  const double q = 0.25 / half;
  switch (largest) {
    case 0:
      return {half, q * (a.y + b.x), q * (a.z + c.x), q * (b.z - c.y)};
    case 1:
      return {q * (a.y + b.x), half, q * (b.z + c.y), q * (c.x - a.z)};
    case 2:
      return {q * (a.z + c.x), q * (b.z + c.y), half, q * (a.y - b.x)};
    default:
      return {q * (b.z - c.y), q * (c.x - a.z), q * (a.y - b.x), half};
  }
}

}  // namespace sf::vision
