#pragma once
// Maps of ROS map_server: a YAML file and the picture it names.

#include <string>
#include <vector>

#include "world/world.h"

namespace sf::world {

inline constexpr double kMapWallHeight =
    2.0;  ///< [m] a flat map says nothing of height: its walls stand from 0 to this

/// Whether the file's name is that of a ROS map: .yaml or .yml, in any case.
bool is_ros_map(const std::string& file);

/// The map as one static model; its frame is the map frame, so that poses mean what they mean in ROS.
/// @throws base::InputError with file and line.
World load_ros_map(const std::string& file, const LoadOptions& options);

/// Likewise of a text that was read; `file` names errors, and the picture is looked for beside it.
World build_ros_map(const std::string& file, const std::string& text, const LoadOptions& options);

/// Outlines, solid on their left, of what the map that `world` was loaded from knows to be free: read from its files
/// again. Empty for a world that is no map, or a map that knows nothing.
std::vector<Segment> known_free(const World& world);

}  // namespace sf::world
