#pragma once
// Maps of ROS map_server: a YAML file and the picture that it names.

#include <string>
#include <vector>

#include "world/bitmap.h"
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

/// Adds the map to a world without one, in the world's frame: its walls and warnings.
/// @throws base::InputError with file and line
void add_ros_map(World& world, const std::string& file, const LoadOptions& options);

/// Outlines of the known free area of the world's map, solid on their left. Reads the map's files again. Empty for a
/// world without a map, and for a map without known free cells.
std::vector<Segment> known_free(const World& world);

/// The space that a ROS map knows: its cells that are not unknown.
class KnownSpace {
 public:
  /// Reads the files of the world's map again. Everything is known where it has none.
  explicit KnownSpace(const World& world);
  /// @param at [m] in the world. False outside of the picture, too
  bool contains(glm::dvec2 at) const;

 private:
  bool limited_ = false;
  Pose X_WL_;                ///< lower left corner
  double resolution_ = 1.0;  ///< [m]
  Bitmap known_;
};

}  // namespace sf::world
