#pragma once
// Images in memory. Pixel (u, v) is column u, row v; whole numbers are the centres of pixels, and (0, 0) is the centre
// of the upper left one (OpenCV's convention).

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sf::vision {

/// Pixels of the largest image: 64 Mpx. Larger ones are refused, so that their number fits OpenCV's int with room for
/// three channels, and memory is bounded.
inline constexpr std::int64_t kMaxImagePixels = std::int64_t{1} << 26;

/// 8 bits a channel, row by row, the top row first.
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

}  // namespace sf::vision
