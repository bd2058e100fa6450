#pragma once
// Reads Stage world files, from disk or from memory.

#include <string>

#include "world/world.h"

namespace sf::world {

/// Builds the world described by `text`. `file` is the name for errors, and its folder is used to find includes and
/// bitmaps; the file itself is not read.
/// @throws base::InputError with file and line
World build_world(const std::string& file, const std::string& text, const LoadOptions& options = {});

}  // namespace sf::world
