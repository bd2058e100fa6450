#pragma once
// Road networks as the rest of the house sees them: a file in, lanes and paint out.

#include <string>
#include <vector>

#include "world/roads/network.h"
#include "world/roads/paint.h"

namespace sf::world {

/// Reads an RNDF and the sidecar beside it. Whatever is not an error joins `warnings`.
/// @throws base::InputError with file and line.
RoadNetwork load_roads(const std::string& rndf_file, std::vector<Warning>& warnings);

}  // namespace sf::world
