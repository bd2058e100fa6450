#include "base/camera_pixels.h"

#include <cmath>

#include "base/jpeg.h"
#include "base/png.h"

namespace sf::base {

std::vector<std::uint8_t> image_bytes(std::span<const double> reading, std::size_t width, bool mono) {
  const std::size_t channels = mono ? 1 : 3;
  std::vector<std::uint8_t> bytes(channels * (reading.size() / width));
  for (std::size_t i = 0; channels * i < bytes.size(); ++i) {
    const double value = reading[i * width + 1];
    const auto rgb = static_cast<std::uint32_t>(value >= 0.0 && value < 0x1p24 ? value : 0.0);
    for (std::size_t part = 0; part < channels; ++part)
      bytes[channels * i + part] = static_cast<std::uint8_t>(rgb >> (16 - 8 * part));
  }
  return bytes;
}

std::vector<std::uint8_t> color_bytes(std::span<const double> reading, std::size_t width) {
  return image_bytes(reading, width, false);
}

std::string color_file(std::span<const double> reading, std::size_t width, const ColorFormat& format) {
  const std::vector<std::uint8_t> bytes = image_bytes(reading, width, format.mono);
  const auto columns = static_cast<int>(format.columns), rows = static_cast<int>(format.rows);
  return format.jpeg > 0 ? encode_jpeg(bytes, columns, rows, format.jpeg)
                         : encode_png(bytes, columns, rows, PngContent::photograph);
}

std::vector<std::uint16_t> millimetre_depths(std::span<const double> reading, std::size_t width,
                                             const RangeLimits& limits) {
  std::vector<std::uint16_t> depths;
  for (std::size_t i = 0; i < reading.size(); i += width) {
    const double millimetres = echo_of(reading[i], limits) == Echo::valid ? std::round(1e3 * reading[i]) : 0.0;
    depths.push_back(static_cast<std::uint16_t>(millimetres > 65535.0 ? 0.0 : millimetres));
  }
  return depths;
}

}  // namespace sf::base
