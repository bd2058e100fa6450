#include "base/srgb.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"

namespace sf::base {

namespace {

double linear_of(double srgb) { return srgb <= 0.04045 ? srgb / 12.92 : exp(2.4 * log((srgb + 0.055) / 1.055)); }

/// Finds 8-bit values by a table of their upper limits, of which no step of the search contains two.
class SrgbTable {
 public:
  SrgbTable() {
    for (int k = 0; k < 255; ++k) limit_[k] = static_cast<float>(linear_of((k + 0.5) / 255.0));
    limit_[255] = HUGE_VALF;
    for (int i = 0, k = 0; i <= kSteps; ++i) {
      while (limit_[k] < static_cast<float>(i) / kSteps) ++k;
      first_[i] = static_cast<std::uint8_t>(k);
    }
  }
  std::uint32_t of(float light) const {
    const float clamped = light > 0.0f ? std::min(light, 1.0f) : 0.0f;
    const std::uint32_t k = first_[static_cast<int>(clamped * kSteps)];
    return k + (limit_[k] < clamped ? 1u : 0u);
  }

 private:
  static constexpr int kSteps = 4096;
  float limit_[256];
  std::uint8_t first_[kSteps + 1];
};

/// Returns whether the next `count` values are equal to the first.
bool are_all(const float* values, std::size_t count) {
  const float first = values[0];
  int differ = 0;
  for (std::size_t k = 1; k <= count; ++k) differ |= values[k] != first ? 1 : 0;
  return differ == 0;
}

}  // namespace

glm::vec3 linear_color(std::uint32_t color) {
  const auto part = [&](int shift) { return static_cast<float>(linear_of((color >> shift & 0xFFu) / 255.0)); };
  return {part(16), part(8), part(0)};
}

std::uint32_t srgb_color(glm::vec3 light) {
  std::uint32_t color;
  srgb_colors(&light.x, &light.y, &light.z, {&color, 1});
  return color;
}

std::uint32_t linear_bytes(glm::vec3 light) {
  std::uint32_t bytes = 0;
  for (int k = 0; k < 3; ++k)  // a comparison with NaN is false
    bytes =
        bytes << 8 | static_cast<std::uint32_t>(light[k] > 0.0f ? std::min(255.0f * light[k], 255.0f) + 0.5f : 0.0f);
  return bytes;
}

void srgb_colors(const float* red, const float* green, const float* blue, std::span<std::uint32_t> out) {
  static const SrgbTable table;
  constexpr std::size_t kBlock = 16;
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = table.of(red[i]) << 16 | table.of(green[i]) << 8 | table.of(blue[i]);
    while (i + kBlock < out.size() && are_all(red + i, kBlock) && are_all(green + i, kBlock) &&
           are_all(blue + i, kBlock)) {
      std::fill_n(&out[i + 1], kBlock, out[i]);
      i += kBlock;
    }
  }
}

}  // namespace sf::base
