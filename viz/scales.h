#pragma once
// Scales beside plots: ticks whose labels fit, the names of axes, and frames. All figures with a plot share them.

#include <string>
#include <vector>

#include "viz/canvas.h"
#include "viz/picture_file.h"
#include "viz/ticks.h"

namespace sf::viz {

/// Ticks for an axis of `pixels` [px] along x: labels side by side never touch, however narrow the plot.
/// @param from, to ends of the axis, from < to
/// @param whole the values are integers, and so are the ticks
Ticks ticks_across(double from, double to, double pixels, bool whole = false);
/// The same along y: labels one above another.
Ticks ticks_up(double from, double to, double pixels, bool whole = false);

/// [px] width of the widest label.
double widest_label(const Ticks& ticks);

/// "distance [m]" as "distance [10⁻⁶ m]", the unit of labels with that exponent.
std::string axis_name(const std::string& name, int exponent);

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
