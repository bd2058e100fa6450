#include "sensors/lidar_modes.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace sf::sensors {

namespace {

/// Calls `visit(a, b, i)` for each beam i that lies between the cast beams a and b.
template <class Visit>
void for_each_between(const LidarBeams& beams, const Visit& visit) {
  for (std::size_t c = 1; c < beams.cast.size(); ++c)  // of two rings: nothing between them
    for (std::uint32_t i = beams.cast[c - 1] + 1; i < beams.cast[c]; ++i) visit(beams.cast[c - 1], beams.cast[c], i);
}

}  // namespace

std::vector<glm::dvec2> interpolation_weights(const LidarBeams& beams) {
  std::vector<glm::dvec2> weights;
  for_each_between(beams, [&](std::uint32_t from, std::uint32_t to, std::uint32_t i) {
    const glm::dvec3 &a = beams.directions[from], &b = beams.directions[to], &d = beams.directions[i];
    const glm::dvec3 normal = glm::cross(a, b);
    const double u = glm::dot(glm::cross(d, b), normal), v = glm::dot(glm::cross(a, d), normal);
    weights.push_back(glm::dvec2(u, v) / std::sqrt(u * u + v * v + 2.0 * u * v * glm::dot(a, b)));
  });
  return weights;
}

void interpolate_columns(const LidarBeams& beams, double range_max, const LidarScan& scan) {
  const glm::dvec2* weights = beams.between.data();
  for_each_between(beams, [&](std::uint32_t a, std::uint32_t b, std::uint32_t i) {
    const glm::dvec2 weight = *weights++;
    const double range_a = scan.values[a * scan.width], range_b = scan.values[b * scan.width];
    const std::uint32_t nearer = range_a <= range_b ? a : b;
    const bool later = i - a > b - i;  // numbers other than ranges are those of the nearest column
    for (std::size_t k = 1; k < scan.width; ++k)
      scan.values[i * scan.width + k] = scan.values[(later ? b : a) * scan.width + k];
    scan.quality[i] = base::QualityFlag::not_cast;
    scan.hits[i] = scan.hits[nearer];
    const bool one = scan.hits[a] == scan.hits[b] && scan.hits[a] != base::kNoHit && range_a > 0.0 && range_b > 0.0;
    scan.values[i * scan.width] =
        one ? std::min(range_max, range_a * range_b / (weight.x * range_b + weight.y * range_a))
            : std::min(range_a, range_b);
  });
}

}  // namespace sf::sensors
