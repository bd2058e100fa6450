#pragma once
// A written picture read back by the other PNG library the farm links, for checks of what a user gets.

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

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
  /// Pixels of `color` in the box [x0, x1) x [y0, y1).
  int count(std::uint32_t color, int x0, int y0, int x1, int y1) const {
    int n = 0;
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) n += at(x, y) == color ? 1 : 0;
    return n;
  }
  /// In all of it.
  int count(std::uint32_t color) const { return count(color, 0, 0, width, height); }
};

/// Fails the test where the file is no PNG.
Picture read_png(const std::string& path);

/// A colour, and the fewest pixels of it.
struct Painted {
  std::uint32_t color;
  int least;
};
/// What a picture must show.
void expect_painted(const std::string& path, std::initializer_list<Painted> expected);

/// A file in the temporary folder that is this test's alone: others run beside it.
std::string own_file(const std::string& name);

}  // namespace sf::scenes
