#pragma once
// Reads written pictures with the PNG library, to check the files that users get.

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include "viz/canvas.h"

namespace sf {
inline constexpr std::uint32_t kWhite = 0xFFFFFFFFu;
inline constexpr std::uint32_t kBlack = 0xFF000000u;
}  // namespace sf

namespace sf::scenes {

struct Picture {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;

  std::uint32_t at(int x, int y) const {
    const std::size_t i =
        3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
    return 0xFF000000u | static_cast<std::uint32_t>(rgb[i] << 16) | static_cast<std::uint32_t>(rgb[i + 1] << 8) |
           rgb[i + 2];
  }
  /// Returns the number of pixels of `color` in the box [x0, x1) x [y0, y1).
  int count(std::uint32_t color, int x0, int y0, int x1, int y1) const {
    int n = 0;
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) n += at(x, y) == color ? 1 : 0;
    return n;
  }
  /// In the whole picture.
  int count(std::uint32_t color) const { return count(color, 0, 0, width, height); }
};

/// Returns the pixels of a drawing.
Picture picture_of(const viz::Canvas& canvas);

/// Fails the test if the file is not a PNG.
Picture read_png(const std::string& path);

/// A colour and the minimum number of its pixels.
struct Painted {
  std::uint32_t color;
  int least;
};
/// Checks that a picture has the given colours.
void expect_painted(const std::string& path, std::initializer_list<Painted> expected);

/// Returns the path of a temporary file for this test only, since tests run in parallel.
std::string own_file(const std::string& name);

}  // namespace sf::scenes
