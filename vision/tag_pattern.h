#pragma once
// Square fiducials: a black border around a code of black and white cells.

#include <cstdint>
#include <vector>

namespace sf::vision {

/// Cells of a tag, including its black border. Its frame T: origin at the centre, x right and y up as printed, z
/// towards the viewer.
struct TagPattern {
  int cells = 0;                    ///< along a side, > 2
  std::vector<std::uint8_t> white;  ///< cells x cells, row by row, the top row first; 1: white
};

}  // namespace sf::vision
