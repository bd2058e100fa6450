#pragma once
// Maps of ROS map_server: a YAML file and the picture that it names.

#include <string>
#include <vector>

#include "world/world.h"

namespace sf::world {

inline constexpr double kMapWallHeight = 2.0;  ///< [m] a map has no heights: its walls stand from 0 to this height

/// True for file names that end in .yaml or .yml, in any case.
bool is_ros_map(const std::string& file);

/// The map as one static model. Its frame is the map frame, so poses are equal to those in ROS.
/// @throws base::InputError with file and line.
World load_ros_map(const std::string& file, const LoadOptions& options);

/// Likewise from a text. `file` is the name for errors; the picture is searched in the folder of `file`.
World build_ros_map(const std::string& file, const std::string& text, const LoadOptions& options);

/// Outlines of the known free area of the map that `world` was loaded from, solid on their left. Reads the map's files
/// again. Empty for a world that is not a map, and for a map without known free cells.
std::vector<Segment> known_free(const World& world);

}  // namespace sf::world
