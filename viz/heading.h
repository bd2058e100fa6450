#pragma once
// Title and subtitle of a figure, broken into as many lines as needed.

#include <string>
#include <vector>

#include "viz/canvas.h"
#include "viz/picture_file.h"

namespace sf::viz {

struct Heading {
  std::vector<std::string> title, subtitle;  ///< lines
  double height = 0.0;                       ///< [px] including the margins above and below
  double edge = 26.0;                        ///< [px] margin above
};

/// Returns `text`, shortened to a width of at most `width` [px].
std::string fitted_text(std::string text, const TextStyle& style, double width);

/// The same for a numbered name: keeps a short last word ("robot 3", "robot sensor 1").
std::string fitted_name(const std::string& name, const TextStyle& style, double width);

/// Breaks `text` at spaces into lines of at most `width` [px]; shortens longer words.
std::vector<std::string> wrapped_text(const std::string& text, const TextStyle& style, double width);

/// Breaks both texts at spaces into lines of at most `width` [px]; shortens longer words. Without lines if the page has
/// no title.
Heading make_heading(const std::string& title, const std::string& subtitle, double width, const Page& page);

/// @param left [px] of the texts; the heading starts at the top of the picture
void draw_heading(Canvas& canvas, double left, const Heading& heading);

}  // namespace sf::viz
