#pragma once
// A run of a fleet in a town: streets, tracks, final poses, convoys and the state of traffic lights.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "viz/picture_file.h"
#include "viz/tracks.h"
#include "world/world.h"

namespace sf::viz {

/// The final state, drawn with the tracks.
struct TownFinalState {
  double time = 0.0;                   ///< [s] time of the final state, also for the lights
  std::vector<std::uint32_t> movers;   ///< row in `World::movers` of each track
  std::vector<std::uint32_t> follows;  ///< per track: the followed track; world::kNone: none
};

/// Draws each track as a thin line with the robot's body at its end. Robots in convoys and their tracks have a separate
/// colour, and a line connects each follower with the robot ahead; robots of an uncommon shape have a third colour.
/// @throws base::InputError naming the path if it cannot be written, or if roads can no longer be read.
void draw_town(const world::World& world, std::span<const Track> tracks, const TownFinalState& end,
               const std::string& path, const Page& page = {});

}  // namespace sf::viz
