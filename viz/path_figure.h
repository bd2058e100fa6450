#pragma once
// Several runs along one lane, as in figures 33, 34, 38 and 39 of the thesis.

#include <span>
#include <string>

#include "viz/picture_file.h"
#include "viz/tracks.h"
#include "world/world.h"

namespace sf::viz {

/// Draws lane markings, magnets and walls, the centre line of each path in the world (dashed), and each track.
/// @throws base::InputError naming the path if it cannot be written.
void draw_along_paths(const world::World& world, std::span<const Track> tracks, const std::string& title,
                      const std::string& subtitle, const std::string& file, const Page& page = {});

}  // namespace sf::viz
