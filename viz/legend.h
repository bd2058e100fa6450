#pragma once
// The legend of a figure: rows of samples with a text beside each.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "viz/canvas.h"
#include "viz/theme.h"

namespace sf::viz {

/// Squares, diamonds, outlined and crossed dots are the states of traffic lights (viz/signal_layer.h).
enum class LegendMark {
  block,
  line,
  dashed,
  dotted,
  dot,
  ring,
  cross,
  robot,
  square,
  diamond,
  hollow_square,
  hollow_diamond,
  outlined_dot,
  crossed_dot,
  hatched,  ///< where nothing was measured
  none      ///< a text alone
};

struct LegendItem {
  LegendMark sample = LegendMark::line;
  std::uint32_t color = theme::kBlack;
  std::string text;
  std::uint32_t edge = theme::kNone;  ///< outline of a block; alpha 0: none
  std::span<const double> dash = {};  ///< of a line; empty: solid
  int row = -1;                       ///< of a line with a marker (`draw_marker`); -1: without
};

/// "and 9 more": of drawn things that the legend does not name.
LegendItem more_item(std::size_t count);

/// The style of all small text beside a figure.
TextStyle small_text();

/// [px]
inline constexpr double kLegendRow = 30.0;

/// Place of each item in rows of at most `width` [px]: its left end and its row.
struct LegendPlace {
  double x = 0.0;
  int row = 0;
};
std::vector<LegendPlace> place_legend(std::span<const LegendItem> items, double width);

/// @param at [px] left end and top of the first row
void draw_legend(Canvas& canvas, glm::dvec2 at, std::span<const LegendItem> items, std::span<const LegendPlace> places);

/// A cross of two strokes, the mark of a contact. @param reach [px] from its middle to its ends, along x and y
void draw_cross(Canvas& canvas, glm::dvec2 at, double reach, double line_width, std::uint32_t color);

/// The mark of a traffic light, with a dark outline. @param radius [px] of the dot; all have its area
void draw_signal(Canvas& canvas, glm::dvec2 at, double radius, LegendMark mark, std::uint32_t color);

/// Dashes of curve `row` [px]: solid, dashed, dotted and so on, in turn. Empty: solid.
std::span<const double> line_style(std::size_t row);

/// The point of curve `row` on its line: a disc, a square, a diamond, a triangle, and the same hollow, in turn.
void draw_marker(Canvas& canvas, glm::dvec2 at, double radius, int row, std::uint32_t color);

/// Diagonal lines over a box.
void draw_hatching(Canvas& canvas, glm::dvec2 low, glm::dvec2 high);

/// A polyline in dashes. @param on, off [px] lengths of dash and gap
void draw_dashes(Canvas& canvas, std::span<const Line> lines, double line_width, double on, double off,
                 std::uint32_t color);

}  // namespace sf::viz
