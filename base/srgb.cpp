#include "base/srgb.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"

namespace sf::base {

namespace {

double linear_of(double srgb) { return srgb <= 0.04045 ? srgb / 12.92 : exp(2.4 * log((srgb + 0.055) / 1.055)); }

/// Finds 8-bit values by a table of their upper limits.
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
    std::uint32_t k = first_[static_cast<int>(clamped * kSteps)];
    while (limit_[k] < clamped) ++k;
    return k;
  }

 private:
  static constexpr int kSteps = 4096;
  float limit_[256];
  std::uint8_t first_[kSteps + 1];
};

}  // namespace

glm::vec3 linear_color(std::uint32_t color) {
  const auto part = [&](int shift) { return static_cast<float>(linear_of((color >> shift & 0xFFu) / 255.0)); };
  return {part(16), part(8), part(0)};
}

std::uint32_t srgb_color(glm::vec3 light) {
  static const SrgbTable table;
  return table.of(light.x) << 16 | table.of(light.y) << 8 | table.of(light.z);
}

}  // namespace sf::base
