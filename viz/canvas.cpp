#include "viz/canvas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "viz/drawing_backend.h"

namespace sf::viz {
namespace {

constexpr int kLargestSide = 16384;

// Height above and below the baseline of letters without accents, relative to the em height.
constexpr double kAscent = 0.78;
constexpr double kDescent = 0.24;

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

/// Returns the length of the UTF-8 character at the start of `text`, or 0 if it cannot be drawn.
std::size_t character_length(std::string_view text) {
  const auto byte = [&](std::size_t k) { return static_cast<std::uint8_t>(text[k]); };
  const std::size_t length = byte(0) < 0x80       ? 1
                             : byte(0) >> 5 == 6  ? 2
                             : byte(0) >> 4 == 14 ? 3
                             : byte(0) >> 3 == 30 ? 4
                                                  : 0;
  if (length == 0 || length > text.size()) return 0;
  std::uint32_t code = length == 1 ? byte(0) : byte(0) & (0x7Fu >> length);
  for (std::size_t k = 1; k < length; ++k) {
    if ((byte(k) & 0xC0) != 0x80) return 0;
    code = code << 6 | (byte(k) & 0x3Fu);
  }
  constexpr std::array<std::uint32_t, 5> kLeast{0, 0x20, 0xA0, 0x800, 0x10000};
  const bool surrogate = code >= 0xD800 && code < 0xE000;
  const bool none = (code & 0xFFFEu) == 0xFFFEu || (code >= 0xFDD0 && code < 0xFDF0) || code == 0x7F;
  return code < kLeast[length] || code > 0x10FFFF || surrogate || none ? 0 : length;
}

/// Returns `text` with '?' in place of invalid UTF-8 and control characters.
std::string drawable(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t length = character_length(text);
    out += length > 0 ? text.substr(0, length) : "?";
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return out;
}

Lettering lettering(const std::string& text, const TextStyle& style) {
  return {drawable(text), style.size, style.bold, style.upwards, {}, style.color | theme::kBlack, style.halo};
}

}  // namespace

glm::dvec2 text_size(const std::string& text, const TextStyle& style) {
  if (text.empty()) return {};
  const glm::dvec2 flat{drawing_backend().text_width(lettering(text, style)), (kAscent + kDescent) * style.size};
  return style.upwards ? glm::dvec2{flat.y, flat.x} : flat;
}

Canvas::Canvas(int width, int height, std::uint32_t background) : drawing_{width, height, background, {}} {
  SF_CHECK(width >= 1 && height >= 1 && width <= kLargestSide && height <= kLargestSide,
           "a canvas of " + std::to_string(width) + " x " + std::to_string(height) + " pixels");
  unclip();
}

void Canvas::clip(const PixelBox& box) {
  clip_ = {std::max(box.x_min, 0), std::max(box.y_min, 0), std::min(box.x_max, width()), std::min(box.y_max, height())};
  drawing_.shapes.push_back(Clip{clip_});
}
void Canvas::unclip() { clip({0, 0, width(), height()}); }

PathBox Canvas::visible(double beyond) const {
  return {{clip_.x_min - beyond, clip_.y_min - beyond}, {clip_.x_max + beyond, clip_.y_max + beyond}};
}

void Canvas::polyline(std::span<const glm::dvec2> points, double line_width, std::uint32_t color,
                      std::span<const double> dash) {
  std::vector<Line> parts;
  if (points.size() == 1) parts.push_back({points[0], points[0]});
  for (std::size_t i = 0; i + 1 < points.size(); ++i) parts.push_back({points[i], points[i + 1]});
  lines(parts, line_width, color, dash);
}

void Canvas::lines(std::span<const Line> lines, double line_width, std::uint32_t color, std::span<const double> dash) {
  Paths paths = cut_lines(lines, visible(line_width));
  if (!paths.empty())
    drawing_.shapes.push_back(Stroke{std::move(paths), line_width, color, {dash.begin(), dash.end()}});
}

void Canvas::line(glm::dvec2 a, glm::dvec2 b, double line_width, std::uint32_t color) {
  const Line one{a, b};
  lines({&one, 1}, line_width, color);
}

void Canvas::polygon(std::span<const glm::dvec2> points, std::uint32_t color) {
  std::vector<glm::dvec2> outline;
  std::copy_if(points.begin(), points.end(), std::back_inserter(outline),
               [](const glm::dvec2& p) { return std::isfinite(p.x + p.y); });
  Paths paths = cut_outlines({std::move(outline)}, visible(1.0));
  if (!paths.empty()) drawing_.shapes.push_back(Fill{std::move(paths), color});
}

void Canvas::area(std::span<const Line> edges, std::uint32_t color) {
  Paths paths = cut_outlines(join_edges(edges), visible(1.0));
  if (!paths.empty()) drawing_.shapes.push_back(Fill{std::move(paths), color});
}

void Canvas::disc(glm::dvec2 center, double radius, std::uint32_t color) { polygon(circle(center, radius), color); }

void Canvas::ring(glm::dvec2 center, double radius, double line_width, std::uint32_t color) {
  std::vector<glm::dvec2> points = circle(center, radius);
  points.push_back(points.front());
  polyline(points, line_width, color);
}

void Canvas::text(glm::dvec2 at, const std::string& text, const TextStyle& style) {
  if (text.empty() || !std::isfinite(at.x + at.y)) return;
  const glm::dvec2 size = text_size(text, style);
  const glm::dvec2 low{anchored(at.x, size.x, style.across), anchored(at.y, size.y, style.down)};
  Lettering letters = lettering(text, style);
  const double rise = kAscent * style.size;
  letters.at = style.upwards ? low + glm::dvec2{rise, size.y} : low + glm::dvec2{0.0, rise};
  drawing_.shapes.push_back(std::move(letters));
}

void Canvas::image(glm::dvec2 from, glm::dvec2 to, const ColorGrid& cells) {
  SF_CHECK(cells.columns > 0 && cells.rows > 0 && to.x > from.x && to.y > from.y &&
               cells.colors.size() == static_cast<std::size_t>(cells.columns) * static_cast<std::size_t>(cells.rows),
           "image of " + std::to_string(cells.columns) + " x " + std::to_string(cells.rows));
  drawing_.shapes.push_back(CellImage{from, to, cells.columns, cells.rows, {cells.colors.begin(), cells.colors.end()}});
}

}  // namespace sf::viz
