#pragma once
// The world for viewers: its walls as a map and as lines, and the outlines of movers in their own frames. Each message
// is sent once.

#include <span>
#include <string_view>

#include "base/bytes.h"
#include "record/run_info.h"

namespace sf::record {

/// Appends a `nav_msgs/OccupancyGrid`: 100 where a wall passes, 0 elsewhere. @pre `shape` has a map
/// @param frame placed at the world's frame
void encode_map(const WorldShape& shape, std::string_view frame, base::Bytes& out);

/// Appends a `visualization_msgs/MarkerArray`: one list of lines per model, in the frame "world".
void encode_walls(const WorldShape& shape, base::Bytes& out);

/// The same, with one list of lines per mover, locked to its frame.
void encode_bodies(std::span<const MoverInfo> movers, base::Bytes& out);

}  // namespace sf::record
