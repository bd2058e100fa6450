#pragma once
// Square fiducials: black border, and inside it a code of black and white cells.

#include <cstdint>
#include <vector>

namespace sf::vision {

/// Cells of a tag, its black border included. Its frame T: origin in the centre, x to the right and y up as printed,
/// z towards the viewer.
struct TagPattern {
  int cells = 0;                    ///< along a side, > 2
  std::vector<std::uint8_t> white;  ///< cells x cells, row by row, the top row first; 1: white
};

}  // namespace sf::vision
