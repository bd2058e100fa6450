#pragma once
// Entry point of road networks for other modules: a file in, lanes and markings out.

#include <optional>
#include <string>
#include <vector>

#include "world/roads/lane_markings.h"
#include "world/roads/network.h"
#include "world/world.h"

namespace sf::world {

/// Reads an RNDF and the sidecar beside it. Problems other than errors are added to `warnings`. @param strict as for
/// `read_rndf`
/// @throws base::InputError with file and line.
RoadNetwork load_roads(const std::string& rndf_file, std::vector<Warning>& warnings, bool strict = false);

/// The network of a loaded world, the first one when there are several; nullopt when there is none. Warnings are
/// dropped, since load_world reported them. @throws base::InputError when the file has changed and can no longer be
/// read.
std::optional<RoadNetwork> roads_of(const World& world);

}  // namespace sf::world
