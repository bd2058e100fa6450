#pragma once
// Title and subtitle of a figure, in as many lines as they need.

#include <string>
#include <vector>

#include "viz/canvas.h"
#include "viz/picture_file.h"

namespace sf::viz {

struct Heading {
  std::vector<std::string> title, subtitle;  ///< lines
  double height = 0.0;                       ///< [px] with the margins above and below
  double edge = 26.0;                        ///< [px] margin above
};

/// `text`, shortened until it is at most `width` [px] wide.
std::string fitted_text(std::string text, const TextStyle& style, double width);

/// The same for the name of one of several things: a short last word ("robot 3", "robot sensor 1") stays.
std::string fitted_name(const std::string& name, const TextStyle& style, double width);

/// `text` in lines of at most `width` [px], broken at spaces; a longer word is shortened.
std::vector<std::string> wrapped_text(const std::string& text, const TextStyle& style, double width);

/// Breaks both texts at spaces into lines of at most `width` [px]; a longer word is shortened. Without lines where the
/// page has no title.
Heading make_heading(const std::string& title, const std::string& subtitle, double width, const Page& page);

/// @param left [px] of the texts; the heading begins at the picture's upper edge
void draw_heading(Canvas& canvas, double left, const Heading& heading);

}  // namespace sf::viz
