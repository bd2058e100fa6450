#pragma once
// A picture in memory. VTK renders the text (viz/text_renderer.h), libspng writes the file (viz/png.h), and lines and
// areas are drawn with analytic coverage (viz/coverage.h). Needs neither a display nor OpenGL.
//
// Coordinates are pixels, x right, y down, (0, 0) the upper left corner of the picture. Colours are 0xAARRGGBB; alpha
// is the opacity of the whole shape, however often it overlaps itself. Points that are not finite are skipped. One
// thread at a time may draw, on any canvas: VTK's font cache is shared.

#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "base/pose.h"
#include "viz/coverage.h"
#include "viz/resample.h"
#include "viz/theme.h"

namespace sf::viz {

/// A straight line between two points, in pixels or in metres.
struct Line {
  glm::dvec2 a;
  glm::dvec2 b;
};

/// [px] coordinate of the middle of the nearest pixel, for crisp one-pixel lines.
inline double crisp(double pixel) { return std::floor(pixel) + 0.5; }

/// Position of the given point on the text's box.
enum class Anchor { start, middle, end };

struct TextStyle {
  int size = 18;  ///< [px] em height, > 0
  std::uint32_t color = theme::kInk;
  bool bold = false;
  bool upwards = false;               ///< turned by 90 degrees, read from below
  Anchor across = Anchor::start;      ///< start: the point is at the left of the text's box
  Anchor down = Anchor::middle;       ///< start: the point is at the top of the text's box
  std::uint32_t halo = theme::kNone;  ///< colour of a soft border for texts over lines; alpha 0: none
};

/// [px] width and height of the box of `text` (UTF-8, one line) on the picture.
glm::dvec2 text_size(const std::string& text, const TextStyle& style);

class Canvas {
 public:
  /// @param width, height [px] in [1, 16384]
  Canvas(int width, int height, std::uint32_t background);
  ~Canvas();
  Canvas(Canvas&&) noexcept;
  Canvas& operator=(Canvas&&) noexcept;

  int width() const;
  int height() const;

  /// Clips subsequent drawing to `box`; initially to the whole picture.
  void clip(const PixelBox& box);
  void unclip();

  /// A line through all points, with round joins and ends. @param line_width [px] > 0
  void polyline(std::span<const glm::dvec2> points, double line_width, std::uint32_t color);
  /// The union of many lines, painted once. @param line_width [px] > 0
  void lines(std::span<const Line> lines, double line_width, std::uint32_t color);
  void line(glm::dvec2 a, glm::dvec2 b, double line_width, std::uint32_t color);

  /// A closed polygon, first point not repeated.
  void polygon(std::span<const glm::dvec2> points, std::uint32_t color);
  /// Areas given by the directed edges of closed outlines in any order; outlines of the same orientation are united.
  void area(std::span<const Line> edges, std::uint32_t color);
  void disc(glm::dvec2 center, double radius, std::uint32_t color);
  void ring(glm::dvec2 center, double radius, double line_width, std::uint32_t color);

  void text(glm::dvec2 at, const std::string& text, const TextStyle& style);

  /// Draws `cells`, the top row first, over [from, to): repeated when a cell is larger than a pixel, averaged when it
  /// is smaller.
  void image(glm::dvec2 from, glm::dvec2 to, const ColorGrid& cells);

  /// 0xFFRRGGBB of a pixel inside the picture.
  std::uint32_t pixel(int x, int y) const;

  /// @throws base::InputError naming the path when it cannot be written.
  void save_png(const std::string& path) const;

 private:
  struct Surface;
  std::unique_ptr<Surface> surface_;
};

}  // namespace sf::viz
