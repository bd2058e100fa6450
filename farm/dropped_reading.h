#pragma once
// A reading that a budget dropped.

#include <cstdint>

namespace sf::farm {

struct DroppedReading {
  std::uint32_t mover = 0;  ///< row in `World::movers`
  std::uint8_t type = 0;    ///< wire id
  std::uint32_t sensor = 0;
};

}  // namespace sf::farm
