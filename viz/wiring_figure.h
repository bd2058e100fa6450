#pragma once
// Draws the graph of derived sensors: one column per level, with arrows from each sensor to those that it feeds.

#include <cstdint>
#include <string>
#include <vector>

#include "viz/picture_file.h"

namespace sf::viz {

/// A sensor in the graph.
struct WiringBox {
  std::string name;                 ///< "gyro 0 of r0"
  std::string detail;               ///< second line: "10 Hz, rate_rad_s"
  std::uint32_t column = 0;         ///< 0: measured sensors
  std::vector<std::size_t> inputs;  ///< rows of earlier columns
};

/// @throws base::InputError naming the path if it cannot be written
void draw_wiring(const std::vector<WiringBox>& boxes, const std::string& subtitle, const std::string& path,
                 const Page& page);

}  // namespace sf::viz
