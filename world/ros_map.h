#pragma once
// Maps of ROS map_server: a YAML file and its picture.

#include <string>
#include <vector>

#include "world/bitmap.h"
#include "world/world.h"

namespace sf::world {

inline constexpr double kMapWallHeight = 2.0;  ///< [m] maps have no heights: walls extend from 0 to this height

/// Returns true for file names that end in .yaml or .yml, in any case.
bool is_ros_map(const std::string& file);

/// Loads the map as one static model. Its frame is the map frame, so poses equal those in ROS.
/// @throws base::InputError with file and line
World load_ros_map(const std::string& file, const LoadOptions& options);

/// Same, from a text. `file` is the name for errors, and its folder is searched for the picture.
World build_ros_map(const std::string& file, const std::string& text, const LoadOptions& options);

/// Adds the map's walls and warnings to a world without a map, in the world frame.
/// @throws base::InputError with file and line
void add_ros_map(World& world, const std::string& file, const LoadOptions& options);

/// Returns outlines of the known free area of the world's map, with the area on their left. Reads the map's files
/// again. Empty for a world without a map, and for a map without known free cells.
std::vector<Segment> known_free(const World& world);

/// The known space of a ROS map: all cells that are not unknown.
class KnownSpace {
 public:
  /// Reads the files of the world's map again. Without a map, everything is known.
  explicit KnownSpace(const World& world);
  /// @param at [m] world frame. False outside the picture
  bool contains(glm::dvec2 at) const;

 private:
  bool limited_ = false;
  Pose X_WL_;                ///< lower left corner
  double resolution_ = 1.0;  ///< [m]
  Bitmap known_;
};

}  // namespace sf::world
