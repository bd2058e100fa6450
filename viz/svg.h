#pragma once
// SVG files of drawings. Texts are `<text>` elements that can be searched, selected and edited.

#include <string>

#include "viz/drawing.h"

namespace sf::viz {

/// Returns an SVG 1.1 document with the drawing's size on paper. @param scale of that size: 1 is 180 layout pixels per
/// inch
std::string to_svg(const Drawing& drawing, double scale = 1.0);

}  // namespace sf::viz
