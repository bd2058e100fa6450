#pragma once
// The mean colour of a part of a raster of cells.

#include <array>
#include <cstdint>
#include <span>

namespace sf::viz {

/// `columns` * `rows` opaque colours, row by row.
struct ColorGrid {
  int columns = 0;
  int rows = 0;
  std::span<const std::uint32_t> colors;
};

/// Mean red, green and blue [0, 255] over the box [u_min, u_max) x [v_min, v_max), in cells, and the area of the box
/// that lies on the raster.
struct BoxMean {
  std::array<double, 3> rgb{};
  double area = 0.0;
};
BoxMean box_mean(const ColorGrid& cells, double u_min, double u_max, double v_min, double v_max);

}  // namespace sf::viz
