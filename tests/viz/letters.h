#pragma once
// The texts of an SVG file, for legibility checks: inside the picture, and without overlaps.

#include <string>
#include <vector>

#include "base/pose.h"

namespace sf::scenes {

struct LetterBox {
  std::string text;
  glm::dvec2 low, high;  ///< [px] of the layout
  double size = 0.0;     ///< [px]
};

std::vector<LetterBox> letters_of(const std::string& svg);

/// Fails the test if a text leaves the picture or touches another one. Ignores labels that are placed where there is
/// room (with a halo).
void expect_legible(const std::string& svg, const std::string& what);

}  // namespace sf::scenes
