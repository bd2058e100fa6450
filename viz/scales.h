#pragma once
// Scales of plots: ticks whose labels fit, axis names and frames. Shared by all figures with a plot.

#include <string>
#include <vector>

#include "viz/canvas.h"
#include "viz/picture_file.h"
#include "viz/ticks.h"

namespace sf::viz {

/// Returns ticks for an axis of `pixels` >= 40 [px] along x: two or more, whose labels never touch.
/// @param from, to ends of the axis, from < to
/// @param whole values and ticks are integers; two ticks if [from, to] contains two integers
Ticks ticks_across(double from, double to, double pixels, bool whole = false);
/// The same along y, with labels one above another, for at least 40 px.
Ticks ticks_up(double from, double to, double pixels, bool whole = false);

/// [px] Returns the width of the widest label.
double widest_label(const Ticks& ticks);

/// Returns the exponent for labels up to `most` > 0 whose multiples have that many `decimals`; 0 unless the labels
/// would be long.
int label_exponent(double most, int decimals);

/// Returns "distance [10⁻⁶ m]" for "distance [m]", the unit of labels with that exponent.
std::string axis_name(const std::string& name, int exponent);
/// The same with the offset of the labels: "time \u2212 1000 [s]".
std::string axis_name(const std::string& name, const Ticks& ticks);

inline constexpr double kNameLine = 22.0;  ///< [px] line spacing of an axis name along y

/// Breaks the name of an axis along y into as many lines as `height` [px] needs.
std::vector<std::string> name_lines(const std::string& name, double height);
/// @param left [px] of the first line; further lines are to its right
void draw_name_up(Canvas& canvas, double left, double middle, const std::vector<std::string>& lines);

/// Draws a label centred at `at`, its upper end; moves it if it would leave the picture.
void draw_label_across(Canvas& canvas, glm::dvec2 at, const std::string& text);

/// [px] Returns the left end of legend and heading: that of the plot, or the edge of a narrow page.
double legend_left(const Page& page, double plot_left);

/// Draws the border of a plot.
void draw_frame(Canvas& canvas, const PixelBox& plot);

}  // namespace sf::viz
