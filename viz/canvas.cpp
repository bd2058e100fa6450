#include "viz/canvas.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <vector>

#include "base/error.h"
#include "viz/png.h"
#include "viz/text_renderer.h"

namespace sf::viz {
namespace {

constexpr int kLargestSide = 16384;

using Channels = std::array<std::uint8_t, 3>;

Channels channels(std::uint32_t color) {
  return {static_cast<std::uint8_t>(color >> 16), static_cast<std::uint8_t>(color >> 8),
          static_cast<std::uint8_t>(color)};
}

float opacity(std::uint32_t color) { return static_cast<float>(color >> 24) / 255.0f; }

void blend(std::uint8_t* pixel, const Channels& color, float amount) {
  for (std::size_t c = 0; c < 3; ++c) {
    const float old = pixel[c];
    pixel[c] = static_cast<std::uint8_t>(old + (static_cast<float>(color[c]) - old) * amount + 0.5f);
  }
}

/// VTK's built-in font has Latin letters only and rounds square brackets, so a complete font is used when one is
/// installed.
const std::string& font_file(bool bold) {
  static const auto installed = [](const char* path) { return std::filesystem::exists(path) ? path : ""; };
  static const std::string regular = installed("/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf");
  static const std::string heavy = installed("/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf");
  return bold ? heavy : regular;
}

/// The glyphs of `text` in a tight box.
GlyphBitmap glyph_bitmap(const std::string& text, const TextStyle& style) {
  GlyphBitmap stencil;
  SF_CHECK(text_renderer().render({text, style.size, style.bold, style.upwards, font_file(style.bold)}, stencil),
           "cannot render '" + text + "'");
  return stencil;
}

double anchored(double at, double size, Anchor anchor) {
  if (anchor == Anchor::start) return at;
  return anchor == Anchor::middle ? at - 0.5 * size : at - size;
}

std::vector<glm::dvec2> circle(glm::dvec2 center, double radius) {
  const int corners = std::clamp(static_cast<int>(4.0 * radius), 16, 360);
  std::vector<glm::dvec2> points;
  points.reserve(static_cast<std::size_t>(corners));
  for (int i = 0; i < corners; ++i) points.push_back(center + base::rotate(2.0 * M_PI * i / corners, {radius, 0.0}));
  return points;
}

}  // namespace

struct Canvas::Surface {
  Surface(int w, int h)
      : width(w),
        height(h),
        pixels(3 * static_cast<std::size_t>(w) * static_cast<std::size_t>(h)),
        strokes(w, h),
        areas(w, h),
        clip{0, 0, w, h} {}
  std::uint8_t* at(int x, int y) {
    return pixels.data() +
           3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
  }
  void paint(CoverageBuffer& rows, bool edges, std::uint32_t color) {
    const Channels rgb = channels(color);
    const float whole = opacity(color);
    rows.drain([&](int y, int x_min, std::span<float> part) {
      if (edges) sum_edges(part);
      std::uint8_t* pixel = at(x_min, y);
      for (const float coverage : part) {
        if (coverage > 0.002f) blend(pixel, rgb, coverage * whole);
        pixel += 3;
      }
    });
  }
  void stamp(const GlyphBitmap& text, int left, int top, std::uint32_t color, float gain) {
    const Channels rgb = channels(color);
    const std::uint8_t* coverage = text.coverage.data();
    for (int y = top; y < top + text.height; ++y)
      for (int x = left; x < left + text.width; ++x) {
        const float alpha = static_cast<float>(*coverage++) / 255.0f;
        const bool inside = y >= clip.y_min && y < clip.y_max && x >= clip.x_min && x < clip.x_max;
        if (inside && alpha > 0.0f) blend(at(x, y), rgb, std::min(1.0f, alpha * gain) * opacity(color));
      }
  }

  int width;
  int height;
  std::vector<std::uint8_t> pixels;  ///< red, green, blue; row by row, the top row first
  CoverageBuffer strokes;
  CoverageBuffer areas;
  PixelBox clip;
};

glm::dvec2 text_size(const std::string& text, const TextStyle& style) {
  if (text.empty()) return {};
  const GlyphBitmap stencil = glyph_bitmap(text, style);
  return {static_cast<double>(stencil.width), static_cast<double>(stencil.height)};
}

Canvas::Canvas(int width, int height, std::uint32_t background) {
  SF_CHECK(width >= 1 && height >= 1 && width <= kLargestSide && height <= kLargestSide,
           "a canvas of " + std::to_string(width) + " x " + std::to_string(height) + " pixels");
  surface_ = std::make_unique<Surface>(width, height);
  const Channels rgb = channels(background);
  for (auto pixel = surface_->pixels.begin(); pixel != surface_->pixels.end(); pixel += 3)
    std::copy(rgb.begin(), rgb.end(), pixel);
}
Canvas::~Canvas() = default;
Canvas::Canvas(Canvas&&) noexcept = default;
Canvas& Canvas::operator=(Canvas&&) noexcept = default;

int Canvas::width() const { return surface_->width; }
int Canvas::height() const { return surface_->height; }

void Canvas::clip(const PixelBox& box) {
  surface_->clip = {std::max(box.x_min, 0), std::max(box.y_min, 0), std::min(box.x_max, width()),
                    std::min(box.y_max, height())};
}
void Canvas::unclip() { surface_->clip = {0, 0, width(), height()}; }

void Canvas::polyline(std::span<const glm::dvec2> points, double line_width, std::uint32_t color) {
  if (points.size() == 1) add_line(surface_->strokes, surface_->clip, points[0], points[0], line_width);
  for (std::size_t i = 0; i + 1 < points.size(); ++i)
    add_line(surface_->strokes, surface_->clip, points[i], points[i + 1], line_width);
  surface_->paint(surface_->strokes, false, color);
}

void Canvas::lines(std::span<const Line> lines, double line_width, std::uint32_t color) {
  for (const Line& l : lines) add_line(surface_->strokes, surface_->clip, l.a, l.b, line_width);
  surface_->paint(surface_->strokes, false, color);
}

void Canvas::line(glm::dvec2 a, glm::dvec2 b, double line_width, std::uint32_t color) {
  const Line one{a, b};
  lines({&one, 1}, line_width, color);
}

void Canvas::polygon(std::span<const glm::dvec2> points, std::uint32_t color) {
  for (std::size_t i = 0; i < points.size(); ++i)
    add_edge(surface_->areas, surface_->clip, points[i], points[(i + 1) % points.size()]);
  surface_->paint(surface_->areas, true, color);
}

void Canvas::area(std::span<const Line> edges, std::uint32_t color) {
  for (const Line& e : edges) add_edge(surface_->areas, surface_->clip, e.a, e.b);
  surface_->paint(surface_->areas, true, color);
}

void Canvas::disc(glm::dvec2 center, double radius, std::uint32_t color) { polygon(circle(center, radius), color); }

void Canvas::ring(glm::dvec2 center, double radius, double line_width, std::uint32_t color) {
  std::vector<glm::dvec2> points = circle(center, radius);
  points.push_back(points.front());
  polyline(points, line_width, color);
}

void Canvas::text(glm::dvec2 at, const std::string& text, const TextStyle& style) {
  if (text.empty()) return;
  const GlyphBitmap letters = glyph_bitmap(text, style);
  const int left = static_cast<int>(std::lround(anchored(at.x, letters.width, style.across)));
  const int top = static_cast<int>(std::lround(anchored(at.y, letters.height, style.down)));
  if (style.halo >> 24) {
    for (int dy = -2; dy <= 2; ++dy)
      for (int dx = -2; dx <= 2; ++dx)
        if (dx * dx + dy * dy <= 5) surface_->stamp(letters, left + dx, top + dy, style.halo, 0.5f);
  }
  surface_->stamp(letters, left, top, style.color, 1.0f);
}

void Canvas::image(glm::dvec2 from, glm::dvec2 to, const ColorGrid& cells) {
  SF_CHECK(cells.columns > 0 && cells.rows > 0 && to.x > from.x && to.y > from.y &&
               cells.colors.size() == static_cast<std::size_t>(cells.columns) * static_cast<std::size_t>(cells.rows),
           "image of " + std::to_string(cells.columns) + " x " + std::to_string(cells.rows));
  const PixelBox& clip = surface_->clip;
  const glm::dvec2 step{cells.columns / (to.x - from.x), cells.rows / (to.y - from.y)};
  const int y_end = std::min(clip.y_max, static_cast<int>(std::ceil(to.y)));
  const int x_end = std::min(clip.x_max, static_cast<int>(std::ceil(to.x)));
  for (int y = std::max(clip.y_min, static_cast<int>(std::floor(from.y))); y < y_end; ++y) {
    const double v = (y - from.y) * step.y;
    for (int x = std::max(clip.x_min, static_cast<int>(std::floor(from.x))); x < x_end; ++x) {
      const double u = (x - from.x) * step.x;
      const BoxMean mean = box_mean(cells, u, u + step.x, v, v + step.y);
      Channels rgb;
      for (std::size_t c = 0; c < 3; ++c) rgb[c] = static_cast<std::uint8_t>(mean.rgb[c] + 0.5);
      blend(surface_->at(x, y), rgb, static_cast<float>(std::min(1.0, mean.area / (step.x * step.y))));
    }
  }
}

std::uint32_t Canvas::pixel(int x, int y) const {
  SF_CHECK(x >= 0 && y >= 0 && x < width() && y < height(),
           "pixel " + std::to_string(x) + ", " + std::to_string(y) + " is outside the picture");
  const std::uint8_t* p = surface_->at(x, y);
  return 0xFF000000u | static_cast<std::uint32_t>(p[0]) << 16 | static_cast<std::uint32_t>(p[1]) << 8 | p[2];
}

void Canvas::save_png(const std::string& path) const { write_png(path, surface_->pixels.data(), width(), height()); }

}  // namespace sf::viz
