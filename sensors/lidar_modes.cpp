#include "sensors/lidar_modes.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace sf::sensors {

namespace {

/// Range along d, turned into the plane of a and b, where it crosses the line through the points at a and b: the
/// inverse range of a line is linear in the direction.
double range_between(glm::dvec3 a, double range_a, glm::dvec3 b, double range_b, glm::dvec3 d) {
  const glm::dvec3 normal = glm::cross(a, b);
  const double u = glm::dot(glm::cross(d, b), normal), v = glm::dot(glm::cross(a, d), normal);
  const double length = std::sqrt(u * u + v * v + 2.0 * u * v * glm::dot(a, b));
  return length / (u / range_a + v / range_b);
}

}  // namespace

void interpolate_columns(const LidarBeams& beams, double range_max, const LidarScan& scan) {
  const std::vector<std::uint32_t>& cast = beams.cast;
  for (std::size_t c = 1; c < cast.size(); ++c) {
    const std::uint32_t a = cast[c - 1], b = cast[c];  // of two rings: nothing between them
    const double range_a = scan.values[a * scan.width], range_b = scan.values[b * scan.width];
    const std::uint32_t nearer = range_a <= range_b ? a : b;
    for (std::uint32_t i = a + 1; i < b; ++i) {
      const bool later = i - a > b - i;  // numbers other than ranges are those of the nearest column
      std::copy_n(scan.values.begin() + static_cast<std::ptrdiff_t>((later ? b : a) * scan.width), scan.width,
                  scan.values.begin() + static_cast<std::ptrdiff_t>(i * scan.width));
      scan.quality[i] = base::QualityFlag::not_cast;
      scan.hits[i] = scan.hits[nearer];
      double& range = scan.values[i * scan.width];
      range = scan.values[nearer * scan.width];
      if (scan.hits[a] == scan.hits[b] && scan.hits[a] != base::kNoHit && range_a > 0.0 && range_b > 0.0)
        range = std::min(
            range_max, range_between(beams.directions[a], range_a, beams.directions[b], range_b, beams.directions[i]));
    }
  }
}

}  // namespace sf::sensors
