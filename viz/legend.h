#pragma once
// The legend of a figure: rows of samples, each with a text.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "viz/canvas.h"
#include "viz/theme.h"

namespace sf::viz {

/// Squares, diamonds, outlined and crossed dots show the states of traffic lights (viz/signal_layer.h).
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
  none      ///< text only
};

struct LegendItem {
  LegendMark sample = LegendMark::line;
  std::uint32_t color = theme::kBlack;
  std::string text;
  std::uint32_t edge = theme::kNone;  ///< outline of a block; alpha 0: none
  std::span<const double> dash = {};  ///< of a line; empty: solid
  int row = -1;                       ///< of a line with a marker (`draw_marker`); -1: no marker
};

/// "and 9 more", for items that the legend does not name.
LegendItem more_item(std::size_t count);

/// Returns the style of all small texts outside of the plot.
TextStyle small_text();

/// [px]
inline constexpr double kLegendRow = 30.0;

/// Position of an item in rows of at most `width` [px]: its left end and its row.
struct LegendPlace {
  double x = 0.0;
  int row = 0;
};
std::vector<LegendPlace> place_legend(std::span<const LegendItem> items, double width);

/// @param at [px] top left of the first row
void draw_legend(Canvas& canvas, glm::dvec2 at, std::span<const LegendItem> items, std::span<const LegendPlace> places);

/// Draws a cross, the mark of a contact. @param reach [px] from its centre to its ends, along x and y
void draw_cross(Canvas& canvas, glm::dvec2 at, double reach, double line_width, std::uint32_t color);

/// Draws the mark of a traffic light, with a dark outline. @param radius [px] of the dot; all marks have the same area
void draw_signal(Canvas& canvas, glm::dvec2 at, double radius, LegendMark mark, std::uint32_t color);

/// Returns the dash pattern [px] of curve `row`: solid, dashed, dotted and so on, repeating. Empty: solid.
std::span<const double> line_style(std::size_t row);

/// Draws the marker of curve `row`: a disc, a square, a diamond, a triangle, and the same hollow, repeating.
void draw_marker(Canvas& canvas, glm::dvec2 at, double radius, int row, std::uint32_t color);

/// Draws diagonal lines over a box.
void draw_hatching(Canvas& canvas, glm::dvec2 low, glm::dvec2 high);

/// Draws a dashed polyline. @param on, off [px] lengths of dash and gap
void draw_dashes(Canvas& canvas, std::span<const Line> lines, double line_width, double on, double off,
                 std::uint32_t color);

}  // namespace sf::viz
