#include "apps/reports/camera_image.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/png.h"
namespace sf::apps {

namespace {

std::uint16_t label_of(std::uint32_t hit) {
  if (hit == base::kNoHit) return 0;
  return hit == base::kFloorHit ? std::uint16_t{1} : static_cast<std::uint16_t>(std::min(hit, kLargestLabel - 2) + 2);
}

std::string normals_png(const base::ReadingBlock& reading, int width, int height) {
  std::vector<std::uint8_t> rgb;
  for (std::size_t i = 0; i < reading.hits.size(); ++i)
    for (std::size_t axis = 2; axis < 5; ++axis)
      rgb.push_back(reading.hits[i] == base::kNoHit
                        ? std::uint8_t{0}
                        : static_cast<std::uint8_t>(std::lround(127.5 * (1.0 + reading.values[5 * i + axis]))));
  return base::encode_png(rgb, width, height);
}

}  // namespace

std::string camera_png(const sensors::CameraSettings& camera, const base::ReadingBlock& reading, ImageKind kind) {
  const auto width = static_cast<int>(camera.width), height = static_cast<int>(camera.height);
  if (kind == ImageKind::normals) return normals_png(reading, width, height);
  const std::size_t step = camera.columns();
  if (kind == ImageKind::colour) return base::encode_png(base::color_bytes(reading.values, step), width, height);
  std::vector<std::uint16_t> grey;
  for (std::size_t i = 0; i < reading.hits.size(); ++i) {
    const double millimetres = std::clamp(std::round(1e3 * reading.values[i * step]), 1.0, 65535.0);
    const bool seen = reading.hits[i] != base::kNoHit;
    grey.push_back(kind == ImageKind::labels ? label_of(reading.hits[i])
                                             : static_cast<std::uint16_t>(seen ? millimetres : 0.0));
  }
  return base::encode_png(grey, width, height);
}

}  // namespace sf::apps
