#pragma once
// Robot ids in packets and their movers in a world.

#include <cstdint>
#include <map>
#include <vector>

#include "world/world.h"

namespace sf::server {

/// Rows of `World::movers` by id on the wire.
struct WireNames {
  std::map<std::uint32_t, std::uint32_t> robots;
  std::map<std::uint32_t, std::uint32_t> tags;
  std::map<std::uint32_t, std::uint32_t> lights;  ///< posts of lights that join, by the id of their intersection
};

WireNames wire_names(const world::World& world);

std::vector<std::uint32_t> ids_of(const std::map<std::uint32_t, std::uint32_t>& rows);

}  // namespace sf::server
