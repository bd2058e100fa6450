#pragma once
// A drawing: the shapes of a figure in the order in which they are painted. PNG, SVG and PDF files are generated from
// it (viz/picture_file.h), so all three look the same.
//
// Coordinates are layout pixels of 1/180 inch, x right, y down, (0, 0) the upper left corner. Colours are 0xAARRGGBB;
// alpha is the opacity of the whole shape, even where it overlaps itself. All numbers are finite.

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "base/pose.h"

namespace sf::viz {

inline constexpr double kPixelsPerInch = 180.0;
inline constexpr double kPixelsPerMillimetre = kPixelsPerInch / 25.4;

/// Half-open box of whole pixels.
struct PixelBox {
  int x_min = 0, y_min = 0, x_max = 0, y_max = 0;
};

using Paths = std::vector<std::vector<glm::dvec2>>;

/// Restricts all later shapes to `box`, replacing the previous clip.
struct Clip {
  PixelBox box;
};
/// Lines of one width with round ends and joins; a path of one point is a dot.
struct Stroke {
  Paths paths;
  double width = 1.0;  ///< [px] > 0
  std::uint32_t color = 0;
  std::vector<double> dash;  ///< [px] lengths of dash, gap, dash, ... along each path, > 0; empty: solid
};
/// Closed outlines, first points not repeated, filled by the non-zero winding rule.
struct Fill {
  Paths paths;
  std::uint32_t color = 0;
};
struct Lettering {
  std::string text;  ///< valid UTF-8 without control characters, not empty
  int size = 18;     ///< [px] em height, > 0
  bool bold = false;
  bool upwards = false;     ///< rotated by 90 degrees, read from below
  glm::dvec2 at;            ///< [px] left end of the baseline
  std::uint32_t color = 0;  ///< opaque
  std::uint32_t halo = 0;   ///< colour of a soft border; alpha 0: none
};
/// Single-coloured cells, the top row first, over [from, to).
struct CellImage {
  glm::dvec2 from, to;
  int columns = 0, rows = 0;
  std::vector<std::uint32_t> colors;  ///< opaque
};
using Shape = std::variant<Clip, Stroke, Fill, Lettering, CellImage>;

inline constexpr double kHaloWidth = 4.4;  ///< [px] of the border around letters with a halo

struct Drawing {
  int width = 0, height = 0;     ///< [px] in [1, 16384]
  std::uint32_t background = 0;  ///< opaque
  std::vector<Shape> shapes;
};

}  // namespace sf::viz
