#pragma once
// The static parts of a world that the page draws, as JSON: everything that messages do not contain.

#include <string>

#include "bridges/viewer_sessions.h"

namespace sf::bridges {

/// Returns the scene with the keys of docs/bridges.md. Lengths are in m, angles in rad, and colours are "#rrggbb".
std::string scene_json(const Scene& scene, ViewerMode mode);

}  // namespace sf::bridges
