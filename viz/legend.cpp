#include "viz/legend.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "viz/color.h"
#include "viz/heading.h"
#include "viz/theme.h"

namespace sf::viz {
namespace {

constexpr double kSampleWidth = 34.0;
constexpr double kTextGap = 9.0;
constexpr double kItemGap = 30.0;
constexpr double kMarker = 5.5;

/// [px] Returns the width of the sample left of a text.
double sample_room(const LegendItem& item) { return item.sample == LegendMark::none ? 0.0 : kSampleWidth + kTextGap; }

void draw_sample(Canvas& canvas, glm::dvec2 left, const LegendItem& item) {
  const glm::dvec2 right = left + glm::dvec2{kSampleWidth, 0.0};
  const glm::dvec2 middle = 0.5 * (left + right);
  const Line line{left, right};
  switch (item.sample) {
    case LegendMark::none:
      return;
    case LegendMark::block: {
      const std::array<glm::dvec2, 5> box{left + glm::dvec2{0, -9}, right + glm::dvec2{0, -9}, right + glm::dvec2{0, 9},
                                          left + glm::dvec2{0, 9}, left + glm::dvec2{0, -9}};
      canvas.polygon(std::span(box).first(4), item.color);
      if (item.edge >> 24) canvas.polyline(box, theme::kOutline, item.edge);
      return;
    }
    case LegendMark::line:
      canvas.lines({&line, 1}, theme::kBold, item.color, item.dash);
      if (item.row >= 0) draw_marker(canvas, middle, kMarker, item.row, item.color);
      return;
    case LegendMark::hatched: {
      const glm::dvec2 low = left + glm::dvec2{0, -9}, high = right + glm::dvec2{0, 9};
      draw_hatching(canvas, low, high);
      return canvas.polyline(std::array{low, glm::dvec2{high.x, low.y}, high, glm::dvec2{low.x, high.y}, low},
                             theme::kHairline, theme::kFrame);
    }
    case LegendMark::dashed:
      return draw_dashes(canvas, {&line, 1}, 2.0, 9.0, 3.5, item.color);
    case LegendMark::dotted:
      return draw_dashes(canvas, {&line, 1}, 2.0, 2.0, 4.0, item.color);
    case LegendMark::dot:
      canvas.disc(middle, 7.5, theme::kWhite);
      return canvas.disc(middle, 6.0, item.color);
    case LegendMark::ring:
      return canvas.ring(middle, 5.5, theme::kCurve, item.color);
    case LegendMark::cross:
      return draw_cross(canvas, middle, 5.0, theme::kCurve, item.color);
    case LegendMark::robot:
      canvas.disc(middle, 9.0, with_opacity(item.color, 0.45));
      canvas.ring(middle, 9.0, theme::kOutline, item.color);
      return canvas.line(middle, middle + glm::dvec2{9.0, 0.0}, theme::kCurve, item.color);
    case LegendMark::outlined_dot:
    case LegendMark::square:
    case LegendMark::diamond:
    case LegendMark::hollow_square:
    case LegendMark::hollow_diamond:
    case LegendMark::crossed_dot:
      return draw_signal(canvas, middle, 6.0, item.sample, item.color);
  }
}

}  // namespace

LegendItem more_item(std::size_t count) {
  return {LegendMark::none, theme::kBlack, "and " + std::to_string(count) + " more"};
}

TextStyle small_text() {
  TextStyle style;
  style.size = 18;
  style.color = theme::kLegendText;
  return style;
}

std::vector<LegendPlace> place_legend(std::span<const LegendItem> items, double width) {
  std::vector<LegendPlace> places;
  LegendPlace next;
  for (const LegendItem& item : items) {
    const double wide = sample_room(item) + text_size(item.text, small_text()).x;
    if (next.x > 0.0 && next.x + wide > width) next = {0.0, next.row + 1};
    places.push_back(next);
    next.x += wide + kItemGap;
  }
  return places;
}

void draw_legend(Canvas& canvas, glm::dvec2 at, std::span<const LegendItem> items,
                 std::span<const LegendPlace> places) {
  for (std::size_t i = 0; i < items.size(); ++i) {
    const glm::dvec2 left = at + glm::dvec2{places[i].x, (places[i].row + 0.5) * kLegendRow};
    draw_sample(canvas, left, items[i]);
    const glm::dvec2 text = left + glm::dvec2{sample_room(items[i]), 0.0};
    canvas.text(text, fitted_name(items[i].text, small_text(), canvas.width() - text.x - 4.0), small_text());
  }
}

void draw_cross(Canvas& canvas, glm::dvec2 at, double reach, double line_width, std::uint32_t color) {
  const std::array<Line, 2> strokes{Line{at - glm::dvec2{reach, reach}, at + glm::dvec2{reach, reach}},
                                    Line{at - glm::dvec2{reach, -reach}, at + glm::dvec2{reach, -reach}}};
  canvas.lines(strokes, line_width, color);
}

std::span<const double> line_style(std::size_t row) {
  constexpr std::array<std::span<const double>, 7> kStyles{
      std::span<const double>{}, theme::kDashed,     theme::kDotted,     theme::kDashDot,
      theme::kLongDashed,        theme::kDashDotDot, theme::kShortDashed};
  return kStyles[row % kStyles.size()];
}

void draw_marker(Canvas& canvas, glm::dvec2 at, double radius, int row, std::uint32_t color) {
  constexpr int kShapes = 4;
  const auto fill = [&](double r, std::uint32_t with) {
    if (row % kShapes == 0) return canvas.disc(at, r, with);
    const int corners = row % kShapes == 3 ? 3 : 4;
    const double first = row % kShapes == 1 ? 0.25 * M_PI : -0.5 * M_PI;
    std::vector<glm::dvec2> outline;
    for (int k = 0; k < corners; ++k)
      outline.push_back(at + base::rotate(first + 2.0 * M_PI * k / corners, {1.2 * r, 0.0}));
    canvas.polygon(outline, with);
  };
  fill(radius, color);
  if (row / kShapes % 2 == 1) fill(0.55 * radius, theme::kWhite);
}

void draw_hatching(Canvas& canvas, glm::dvec2 low, glm::dvec2 high) {
  constexpr double kApart = 9.0;
  std::vector<Line> strokes;
  const glm::dvec2 size = high - low;
  for (double x = kApart; x < size.x + size.y; x += kApart) {  // from the left or lower side to the right
    const double from = std::max(0.0, x - size.y), to = std::min(x, size.x);
    strokes.push_back({{low.x + from, low.y + x - from}, {low.x + to, low.y + x - to}});
  }
  canvas.lines(strokes, theme::kHairline, theme::kNoReading);
}

void draw_signal(Canvas& canvas, glm::dvec2 at, double radius, LegendMark mark, std::uint32_t color) {
  constexpr double kEdge = 1.5;
  const bool square = mark == LegendMark::square || mark == LegendMark::hollow_square;
  const bool diamond = mark == LegendMark::diamond || mark == LegendMark::hollow_diamond;
  const auto fill = [&](double r, std::uint32_t with) {
    if (!square && !diamond) return canvas.disc(at, r, with);
    const double half = 0.5 * std::sqrt(M_PI) * r, corner = std::sqrt(2.0) * half;
    const std::array<glm::dvec2, 4> box{at + glm::dvec2{-half, -half}, at + glm::dvec2{half, -half},
                                        at + glm::dvec2{half, half}, at + glm::dvec2{-half, half}};
    const std::array<glm::dvec2, 4> tip{at + glm::dvec2{-corner, 0}, at + glm::dvec2{0, -corner},
                                        at + glm::dvec2{corner, 0}, at + glm::dvec2{0, corner}};
    canvas.polygon(square ? box : tip, with);
  };
  fill(radius + kEdge, theme::kInk);
  fill(radius, color);
  if (mark == LegendMark::hollow_square || mark == LegendMark::hollow_diamond) fill(0.5 * radius, theme::kWhite);
  if (mark == LegendMark::crossed_dot) draw_cross(canvas, at, 0.5 * radius, kEdge, theme::kWhite);
}

void draw_dashes(Canvas& canvas, std::span<const Line> lines, double line_width, double on, double off,
                 std::uint32_t color) {
  std::vector<Line> dashes;
  const double period = on + off;
  double done = 0.0;
  glm::dvec2 end{NAN, NAN};
  for (const Line& l : lines) {
    if (l.a.x != end.x || l.a.y != end.y) done = 0.0;
    end = l.b;
    const double whole = length(l.b - l.a);
    if (!(whole > 0.0) || !(whole < 1e6)) continue;
    const glm::dvec2 along = (1.0 / whole) * (l.b - l.a);
    for (double from = -std::fmod(done, period); from < whole; from += period) {
      if (from + on <= 0.0) continue;
      dashes.push_back({l.a + std::max(from, 0.0) * along, l.a + std::min(from + on, whole) * along});
    }
    done += whole;
  }
  canvas.lines(dashes, line_width, color);
}

}  // namespace sf::viz
