#pragma once
// Golden records of drawings (tests/golden.h): an SVG file in which adjacent paths of one style are joined, long paths
// are replaced by their measures, and images by their cells.

#include <string>

#include "tests/viz/png.h"

namespace sf::scenes {

/// Returns the record of an SVG document.
std::string drawing_record(const std::string& svg);

/// Compares the record of the SVG file with the golden one. If SENSORFARM_RECORDS=FOLDER is set, also writes the
/// drawing to FOLDER/NAME.svg.
void expect_recorded(const std::string& svg_file, const std::string& module, const std::string& name);

/// Compares the SVG file that `draw(path)` writes with the golden record `name` of tests/viz.
template <class Draw>
void expect_drawing(const std::string& name, Draw&& draw) {
  const std::string file = own_file(name + ".svg");
  draw(file);
  expect_recorded(file, "viz", name);
}

}  // namespace sf::scenes
