#pragma once
// The static parts of a world that the page draws, as JSON: everything that messages do not contain.

#include <string>

#include "bridges/viewer_sessions.h"

namespace sf::bridges {

/// The keys are described in docs/bridges.md. Lengths in m, angles in rad, colours as "#rrggbb".
std::string scene_json(const Scene& scene, ViewerMode mode);

}  // namespace sf::bridges
