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
};

/// Breaks both texts at spaces into lines of at most `width` [px]; a longer word is shortened. Without lines where the
/// page has no title.
Heading make_heading(const std::string& title, const std::string& subtitle, double width, const Page& page);

/// @param left [px] of the texts; the heading begins at the picture's upper edge
void draw_heading(Canvas& canvas, double left, const Heading& heading);

}  // namespace sf::viz
