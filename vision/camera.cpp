#include "vision/camera.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/elementary.h"
#include "base/lens.h"
#include "base/pose.h"

namespace sf::vision {

namespace {

constexpr double kMaxTangent = 5.67;  // of 80 degrees
constexpr double kMaxDepth = 1e3;     // [m]

}  // namespace

bool is_camera_name(std::string_view name) {
  const auto is_plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
  };
  return !name.empty() && name.size() <= 64 && is_plain(name[0]) &&
         std::all_of(name.begin(), name.end(), [&](char c) { return is_plain(c) || c == '_' || c == '-'; });
}

glm::dvec2 distort(const Intrinsics& intrinsics, glm::dvec2 normalised) {
  return intrinsics.center + intrinsics.focal * base::distorted(intrinsics.distortion, normalised);
}

glm::dvec2 undistort(const Intrinsics& intrinsics, glm::dvec2 pixel) {
  const glm::dvec2 bent = (pixel - intrinsics.center) / intrinsics.focal;
  return base::undistorted(intrinsics.distortion, bent, bent);
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
      if (!base::distortion_jacobian(intrinsics.distortion, n).is_positive()) return false;
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
