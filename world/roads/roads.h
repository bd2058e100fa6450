#pragma once
// Road networks as the rest of the house sees them: a file in, lanes and paint out.

#include <optional>
#include <string>
#include <vector>

#include "world/roads/lane_markings.h"
#include "world/roads/network.h"
#include "world/world.h"

namespace sf::world {

/// Reads an RNDF and the sidecar beside it. Whatever is not an error joins `warnings`. @param strict as of `read_rndf`
/// @throws base::InputError with file and line.
RoadNetwork load_roads(const std::string& rndf_file, std::vector<Warning>& warnings, bool strict = false);

/// The network of a world that was read, its first where it has several; nothing where it has none. What there was to
/// warn of was said when the world was read. @throws base::InputError when its file is no longer as it was.
std::optional<RoadNetwork> roads_of(const World& world);

}  // namespace sf::world
