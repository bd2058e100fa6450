#include "apps/reports/camera_image.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include "base/marked_values.h"
#include "base/png.h"

namespace sf::apps {

namespace {

std::uint16_t label_of(std::uint32_t hit) {
  if (hit == base::kNoHit) return 0;
  return hit == base::kFloorHit ? std::uint16_t{1} : static_cast<std::uint16_t>(std::min(hit, kLargestLabel - 2) + 2);
}

std::vector<std::uint16_t> labels_of(const base::ReadingBlock& reading) {
  std::vector<std::uint16_t> labels;
  for (const std::uint32_t hit : reading.hits) labels.push_back(label_of(hit));
  return labels;
}

std::vector<std::uint16_t> depths_of(const sensors::CameraSettings& camera, const base::ReadingBlock& reading) {
  std::vector<double> marked;
  return base::millimetre_depths(base::marked_values(reading, marked), camera.columns(),
                                 {camera.range_min, camera.range_max});
}

std::vector<std::uint8_t> normals_of(const base::ReadingBlock& reading) {
  std::vector<std::uint8_t> rgb;
  for (std::size_t i = 0; i < reading.hits.size(); ++i)
    for (std::size_t axis = 2; axis < 5; ++axis)
      rgb.push_back(reading.hits[i] == base::kNoHit
                        ? std::uint8_t{0}
                        : static_cast<std::uint8_t>(std::lround(127.5 * (1.0 + reading.values[5 * i + axis]))));
  return rgb;
}

}  // namespace

bool is_jpeg(const std::string& file) {
  const std::filesystem::path suffix = std::filesystem::path(file).extension();
  return suffix == ".jpg" || suffix == ".jpeg";
}

std::string camera_file(const sensors::CameraSettings& camera, const base::ReadingBlock& reading, ImageKind kind,
                        bool jpeg) {
  const auto width = static_cast<int>(camera.width), height = static_cast<int>(camera.height);
  if (kind == ImageKind::depth) return base::encode_png(depths_of(camera, reading), width, height);
  if (kind == ImageKind::labels) return base::encode_png(labels_of(reading), width, height);
  if (kind == ImageKind::normals) return base::encode_png(normals_of(reading), width, height);
  base::ColorFormat format = camera.format();
  format.jpeg = jpeg ? camera.jpeg_quality() : 0;
  return base::color_file(reading.values, camera.columns(), format);
}

std::uint64_t labels_beyond(const base::ReadingBlock& reading) {
  return static_cast<std::uint64_t>(std::ranges::count_if(reading.hits, [](std::uint32_t hit) {
    return hit != base::kNoHit && hit != base::kFloorHit && hit > kLargestLabel - 2;
  }));
}

}  // namespace sf::apps
