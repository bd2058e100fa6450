// Finds the edges of a tag with sub-pixel accuracy.

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "vision/median.h"
#include "vision/tag_fit.h"

namespace sf::vision {

namespace {

constexpr double kStep = 0.5;        // [px] between samples across an edge
constexpr double kMinContrast = 12;  // [grey]
constexpr double kEnds = 0.12;       // fraction of a side skipped at each end, where the adjacent side's edge is near

/// One side of a tag, and grey values across it.
struct Side {
  glm::dvec2 from, along, outward;      ///< [px]; `along` has the length of the side, `outward` is a unit vector
  int profiles = 0, samples = 0;        ///< along, across
  std::size_t inside = 0, outside = 0;  ///< samples in the middle of the black border, and equally far outside
  std::vector<double> grey;             ///< one profile after another, each from inside to outside

  glm::dvec2 foot(int profile) const {
    return from + (kEnds + (1.0 - 2.0 * kEnds) * (profile + 0.5) / profiles) * along;
  }
};

Side sample_side(const Image& image, glm::dvec2 a, glm::dvec2 b, glm::dvec2 center, double cell) {
  Side side{a, b - a, {}, 0, 0, 0, 0, {}};
  const double length = glm::length(side.along);
  side.outward = glm::dvec2{side.along.y, -side.along.x} / length;
  if (glm::dot(side.outward, 0.5 * (a + b) - center) < 0.0) side.outward = -side.outward;
  side.profiles = std::clamp(static_cast<int>((1.0 - 2.0 * kEnds) * length), 4, 60);
  const int border = static_cast<int>(std::clamp(0.5 * cell, 1.0, 4.0) / kStep);
  side.samples = 2 * (border + 1) + 1;
  side.inside = 1;
  side.outside = static_cast<std::size_t>(side.samples - 2);
  for (int i = 0; i < side.profiles; ++i)
    for (int k = 0; k < side.samples; ++k)
      side.grey.push_back(grey_at(image, side.foot(i) + kStep * (k - side.samples / 2) * side.outward));
  return side;
}

/// [px] Returns the outward distance from the profile's foot at which the grey value rises through `level`; the
/// crossing nearest to the foot.
std::optional<double> crossing(std::span<const double> profile, double level) {
  std::optional<double> nearest;
  const auto middle = static_cast<double>(profile.size() / 2);
  for (std::size_t k = 0; k + 1 < profile.size(); ++k) {
    if (!(profile[k] < level) || profile[k + 1] < level) continue;
    const double at = kStep * (static_cast<double>(k) - middle + (level - profile[k]) / (profile[k + 1] - profile[k]));
    if (!nearest || std::abs(at) < std::abs(*nearest)) nearest = at;
  }
  return nearest;
}

double mean_of_three(std::span<const double> profile, std::size_t at) {
  return (profile[at - 1] + profile[at] + profile[at + 1]) / 3.0;
}

/// Returns where the side's profiles cross the mean of black and white: [px] along `outward`, nullopt if they do not.
/// Empty without contrast.
std::vector<std::optional<double>> crossings(const Side& side) {
  const auto profile = [&](int i) {
    const auto samples = static_cast<std::size_t>(side.samples);
    return std::span<const double>(side.grey).subspan(static_cast<std::size_t>(i) * samples, samples);
  };
  std::vector<double> dark, light;
  for (int i = 0; i < side.profiles; ++i) {
    dark.push_back(mean_of_three(profile(i), side.inside));
    light.push_back(mean_of_three(profile(i), side.outside));
  }
  const double black = median(dark), white = median(light);
  std::vector<std::optional<double>> found;
  if (white - black < kMinContrast) return found;
  for (int i = 0; i < side.profiles; ++i) found.push_back(crossing(profile(i), 0.5 * (black + white)));
  return found;
}

/// Moves the ends of the side by the medians of the crossings in its two halves.
void move_ends(const Side& side, const std::vector<std::optional<double>>& found, glm::dvec2& a, glm::dvec2& b) {
  std::vector<double> first, second;
  for (std::size_t i = 0; i < found.size(); ++i)
    if (found[i]) (2 * i < found.size() ? first : second).push_back(*found[i]);
  if (first.empty() || second.empty()) return;
  // The medians represent the points at a quarter and three quarters of the profiles' span.
  const double mean = 0.5 * (median(first) + median(second));
  const double slope = (median(second) - median(first)) / (0.5 * (1.0 - 2.0 * kEnds));
  a += (mean - 0.5 * slope) * side.outward;
  b += (mean + 0.5 * slope) * side.outward;
}

}  // namespace

double grey_at(const Image& image, glm::dvec2 p) {
  const double u = std::clamp(p.x, 0.0, image.width - 1.001), v = std::clamp(p.y, 0.0, image.height - 1.001);
  const int u0 = static_cast<int>(u), v0 = static_cast<int>(v);
  const double a = u - u0, b = v - v0;
  const std::uint8_t* top = image.at(u0, v0);
  const std::uint8_t* low = image.at(u0, v0 + 1);
  return (1.0 - b) * ((1.0 - a) * top[0] + a * top[1]) + b * ((1.0 - a) * low[0] + a * low[1]);
}

void find_edges(const Image& image, const TagOutline& outline, int cells, std::vector<EdgePoint>& out) {
  out.clear();
  const auto& c = outline.corners;
  const glm::dvec2 center = 0.25 * (c[0] + c[1] + c[2] + c[3]);
  for (int i = 0; i < 4; ++i) {
    glm::dvec2 a = c[static_cast<std::size_t>(i)], b = c[static_cast<std::size_t>((i + 1) % 4)];
    if (glm::length(b - a) < 4.0) continue;
    const double cell = glm::length(b - a) / cells;
    const Side rough = sample_side(image, a, b, center, cell);
    move_ends(rough, crossings(rough), a, b);
    const Side side = sample_side(image, a, b, center, cell);
    const auto found = crossings(side);
    for (std::size_t k = 0; k < found.size(); ++k)
      if (found[k]) out.push_back({side.foot(static_cast<int>(k)) + *found[k] * side.outward, i});
  }
}

}  // namespace sf::vision
