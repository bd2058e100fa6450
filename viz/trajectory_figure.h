#pragma once
// The tracks of all movers.

#include <span>
#include <string>
#include <string_view>

#include "viz/picture_file.h"
#include "viz/tracks.h"
#include "world/world.h"

namespace sf::viz {

/// Draws the walls, each track in its own colour with its start, its end and its contacts (one mark per contact), later
/// tracks over earlier ones. Up to seven tracks are named in the legend, more beside their ends, as
/// far as there is room.
/// @param what meaning of one track, for the subtitle: robots of one run, or trials of one robot
/// @throws base::InputError naming the path when it cannot be written.
void draw_trajectories(const world::World& world, std::span<const Track> tracks, const std::string& path,
                       std::string_view what = "robot", const Page& page = {});

}  // namespace sf::viz
