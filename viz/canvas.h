#pragma once
// Adds shapes to a drawing (viz/drawing.h). The drawing backend measures text; it is loaded with the first figure
// (viz/drawing_backend.h). Needs neither a display nor OpenGL.
//
// Coordinates are layout pixels, 180 per inch, x right, y down, (0, 0) the upper left corner of the picture. Colours
// are 0xAARRGGBB; alpha is the opacity of the whole shape, even where it overlaps itself. Points that are not finite
// are skipped. Only one thread at a time may draw, on any canvas, since the fonts are shared.

#include <cmath>
#include <cstdint>
#include <span>
#include <string>

#include "base/pose.h"
#include "viz/drawing.h"
#include "viz/paths.h"
#include "viz/theme.h"

namespace sf::viz {

/// `columns` * `rows` opaque colours, row by row.
struct ColorGrid {
  int columns = 0;
  int rows = 0;
  std::span<const std::uint32_t> colors;
};

/// [px] Returns the coordinate of the centre of the nearest pixel, for crisp one-pixel lines.
inline double crisp(double pixel) { return std::floor(pixel) + 0.5; }

/// Position of the given point on the bounding box of the text.
enum class Anchor { start, middle, end };

struct TextStyle {
  int size = 18;  ///< [px] em height, > 0
  std::uint32_t color = theme::kInk;
  bool bold = false;
  bool upwards = false;               ///< rotated by 90 degrees, read from below
  Anchor across = Anchor::start;      ///< start: the point is at the left of the box
  Anchor down = Anchor::middle;       ///< start: the point is at the top of the box
  std::uint32_t halo = theme::kNone;  ///< colour of a soft border for texts over lines; alpha 0: none
};

/// Returns width and height [px] of the box of `text` (UTF-8, one line). The height covers all letters, so that
/// adjacent texts share a baseline.
glm::dvec2 text_size(const std::string& text, const TextStyle& style);

class Canvas {
 public:
  /// @param width, height [px] in [1, 16384]
  Canvas(int width, int height, std::uint32_t background);

  int width() const { return drawing_.width; }
  int height() const { return drawing_.height; }

  /// Clips subsequent drawing to `box`. Initially the clip is the whole picture.
  void clip(const PixelBox& box);
  void unclip();

  /// Draws a line through all points, with round joins and ends. @param line_width [px] > 0
  void polyline(std::span<const glm::dvec2> points, double line_width, std::uint32_t color,
                std::span<const double> dash = {});
  /// Draws the union of many lines, painted once. @param line_width [px] > 0 @param dash as in `Stroke`
  void lines(std::span<const Line> lines, double line_width, std::uint32_t color, std::span<const double> dash = {});
  void line(glm::dvec2 a, glm::dvec2 b, double line_width, std::uint32_t color);

  /// Fills a closed polygon; the first point is not repeated.
  void polygon(std::span<const glm::dvec2> points, std::uint32_t color);
  /// Fills areas given by the directed edges of closed outlines in any order; outlines with the same orientation are
  /// united.
  void area(std::span<const Line> edges, std::uint32_t color);
  void disc(glm::dvec2 center, double radius, std::uint32_t color);
  void ring(glm::dvec2 center, double radius, double line_width, std::uint32_t color);

  void text(glm::dvec2 at, const std::string& text, const TextStyle& style);

  /// Draws `cells`, the top row first, over [from, to). Cells larger than a pixel are repeated, smaller ones averaged.
  void image(glm::dvec2 from, glm::dvec2 to, const ColorGrid& cells);

  const Drawing& drawing() const { return drawing_; }

 private:
  PathBox visible(double beyond) const;

  Drawing drawing_;
  PixelBox clip_;
};

}  // namespace sf::viz
