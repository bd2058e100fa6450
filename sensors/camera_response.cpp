#include "sensors/camera_response.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "base/elementary.h"

namespace sf::sensors {

double CameraResponse::falloff(glm::dvec2 pixel, glm::dvec2 size) const {
  const glm::dvec2 corner = 0.5 * (size - 1.0), from = pixel - corner;
  return 1.0 - vignetting * glm::dot(from, from) / std::max(1.0, glm::dot(corner, corner));
}

LensBlur::LensBlur(double sigma) {
  if (sigma < 0.05) return;
  const int reach = std::max(3, static_cast<int>(std::ceil(4.0 * sigma)));
  const auto weight = [sigma](int i) { return base::exp(-0.5 * i * i / (sigma * sigma)); };
  double sum = 0.0;
  for (int i = -reach; i <= reach; ++i) sum += weight(i);
  for (int i = -reach; i <= reach; ++i) taps_.push_back(static_cast<float>(weight(i) / sum));
}

template <class Light>
void LensBlur::blur(std::span<Light> image, std::size_t width) const {
  if (taps_.empty() || image.empty()) return;
  const std::size_t height = image.size() / width, reach = taps_.size() / 2;
  const auto add = [width](float tap, const Light* from, Light* to) {
    for (std::size_t u = 0; u < width; ++u) to[u] += tap * from[u];
  };
  // Along rows, then along columns.
  std::vector<Light> across(image.size()), row(width + 2 * reach);
  for (std::size_t v = 0; v < height; ++v) {
    const auto from = image.subspan(v * width, width);
    std::fill_n(row.begin(), reach, from.front());
    std::ranges::copy(from, row.begin() + static_cast<std::ptrdiff_t>(reach));
    std::fill(row.end() - static_cast<std::ptrdiff_t>(reach), row.end(), from.back());
    for (std::size_t i = 0; i < taps_.size(); ++i) add(taps_[i], &row[i], &across[v * width]);
  }
  std::ranges::fill(image, Light{});
  for (std::size_t v = 0; v < height; ++v)
    for (std::size_t i = 0; i < taps_.size(); ++i) {
      const std::size_t line = std::min(v + i < reach ? 0 : v + i - reach, height - 1);
      add(taps_[i], &across[line * width], &image[v * width]);
    }
}

template void LensBlur::blur(std::span<float>, std::size_t) const;
template void LensBlur::blur(std::span<glm::vec3>, std::size_t) const;

}  // namespace sf::sensors
