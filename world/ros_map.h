#pragma once
// Maps of ROS map_server: a YAML file and the picture it names.

#include <string>

#include "world/world.h"

namespace sf::world {

inline constexpr double kMapWallHeight =
    2.0;  ///< [m] a flat map says nothing of height: its walls stand from 0 to this

/// The map as one static model; its frame is the map frame, so that poses mean what they mean in ROS.
/// @throws base::InputError with file and line.
World load_ros_map(const std::string& file, const LoadOptions& options);

}  // namespace sf::world
