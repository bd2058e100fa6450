#pragma once
// Images in memory. Pixel (u, v) is column u, row v. Integers are pixel centres, and (0, 0) is the centre of the upper
// left pixel (OpenCV's convention).

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sf::vision {

/// Maximum number of pixels of an image: 64 Mpx. Larger images are rejected, which limits memory and keeps the size of
/// three channels within OpenCV's int.
inline constexpr std::int64_t kMaxImagePixels = std::int64_t{1} << 26;

/// 8 bits per channel, row by row, the top row first.
struct Image {
  int width = 0;                     ///< [px]
  int height = 0;                    ///< [px]
  int channels = 1;                  ///< 1: grey; 3: red, green, blue
  std::vector<std::uint8_t> pixels;  ///< width x height x channels

  const std::uint8_t* at(int u, int v) const {
    return pixels.data() + (static_cast<std::size_t>(v) * width + u) * channels;
  }
  std::uint8_t* at(int u, int v) { return pixels.data() + (static_cast<std::size_t>(v) * width + u) * channels; }
};

/// A rectangle of pixels.
struct Region {
  int left = 0, top = 0;      ///< [px] of its first pixel
  int width = 0, height = 0;  ///< [px]

  std::int64_t area() const { return std::int64_t{width} * height; }
};

inline Region whole(const Image& image) { return {0, 0, image.width, image.height}; }

}  // namespace sf::vision
