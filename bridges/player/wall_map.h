#pragma once
// The walls of a world as Player's map: line segments, and a grid of free and occupied cells.

#include <cstdint>

#include "netio/player/xdr.h"
#include "record/run_info.h"
#include "world/world.h"

namespace sf::bridges::player {

using namespace netio::player;

/// A rectangle of the grid.
struct Tile {
  std::uint32_t col = 0, row = 0, width = 0, height = 0;  ///< [cells]
};

/// player_map_info
void put_map_info(const record::WorldShape& shape, XdrWriter& xdr);
/// Appends player_map_data of the part of `tile` that is inside the grid, compressed: 1 for occupied cells, else -1.
/// @return false: it is empty
bool put_map_tile(const record::WorldShape& shape, const Tile& tile, XdrWriter& xdr);
/// Appends player_map_data_vector of the walls that stop robots, as many as fit a message.
void put_map_segments(const world::World& world, XdrWriter& xdr);

}  // namespace sf::bridges::player
