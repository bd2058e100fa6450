#pragma once
// Entry point to road networks for other modules: reads a file and returns lanes and markings.

#include <optional>
#include <string>
#include <vector>

#include "world/roads/lane_markings.h"
#include "world/roads/network.h"
#include "world/world.h"

namespace sf::world {

/// Reads an RNDF and the sidecar in the same folder. Adds problems other than errors to `warnings`.
/// @param strict as in `read_rndf`
/// @throws base::InputError with file and line
RoadNetwork load_roads(const std::string& rndf_file, std::vector<Warning>& warnings, bool strict = false);

/// Returns the network of a loaded world (the first of several), or nullopt if there is none. Drops warnings, since
/// load_world has reported them.
/// @throws base::InputError if the file has changed and can no longer be read
std::optional<RoadNetwork> roads_of(const World& world);

}  // namespace sf::world
