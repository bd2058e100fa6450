#pragma once
// Scales beside plots: ticks whose labels fit, the names of axes, and frames. All figures with a plot share them.

#include <string>
#include <vector>

#include "viz/canvas.h"
#include "viz/picture_file.h"
#include "viz/ticks.h"

namespace sf::viz {

/// Ticks for an axis of `pixels` [px] along x: two or more, whose labels never touch, from 40 px on.
/// @param from, to ends of the axis, from < to
/// @param whole the values are integers, and so are the ticks: two where [from, to] has two integers
Ticks ticks_across(double from, double to, double pixels, bool whole = false);
/// The same along y: labels one above another, from 40 px on.
Ticks ticks_up(double from, double to, double pixels, bool whole = false);

/// [px] width of the widest label.
double widest_label(const Ticks& ticks);

/// Exponent of labels up to `most` > 0 whose multiples have that many `decimals`: 0 unless they would be long.
int label_exponent(double most, int decimals);

/// "distance [m]" as "distance [10⁻⁶ m]", the unit of labels with that exponent.
std::string axis_name(const std::string& name, int exponent);
/// The same with the offset of the labels: "time \u2212 1000 [s]".
std::string axis_name(const std::string& name, const Ticks& ticks);

inline constexpr double kNameLine = 22.0;  ///< [px] between the lines of an axis' name along y

/// The name of an axis along y, in as many lines as `height` [px] needs.
std::vector<std::string> name_lines(const std::string& name, double height);
/// @param left [px] of the first line; the others are to its right
void draw_name_up(Canvas& canvas, double left, double middle, const std::vector<std::string>& lines);

/// A label centred at `at`, its upper end; moved as far as it would leave the picture.
void draw_label_across(Canvas& canvas, glm::dvec2 at, const std::string& text);

/// [px] left end of a legend and a heading: that of the plot, or the edge of a narrow page.
double legend_left(const Page& page, double plot_left);

/// The border of a plot.
void draw_frame(Canvas& canvas, const PixelBox& plot);

}  // namespace sf::viz
