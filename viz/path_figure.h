#pragma once
// Several runs along one lane: the thesis' figures 33, 34, 38 and 39.

#include <span>
#include <string>

#include "viz/picture_file.h"
#include "viz/tracks.h"
#include "world/world.h"

namespace sf::viz {

/// Draws lane markings, magnets and walls, the centre line of each path of the world (dashed), and each track.
/// @throws base::InputError naming the path when it cannot be written.
void draw_along_paths(const world::World& world, std::span<const Track> tracks, const std::string& title,
                      const std::string& subtitle, const std::string& file, const Page& page = {});

}  // namespace sf::viz
