#pragma once
// The YAML of a ROS map, as map_server reads it.

#include <string>
#include <vector>

#include "world/world.h"

namespace sf::world {

struct RosMap {
  enum class Mode { trinary, scale, raw };

  std::string image;        ///< path
  int image_line = 0;       ///< line of `image` in the YAML, 1-based
  double resolution = 0.0;  ///< [m] per pixel
  Pose X_WL;                ///< lower left corner of the picture in the map frame
  bool negate = false;      ///< true: bright pixels are occupied
  double occupied = 0.65;   ///< [-] above: wall
  double free = 0.196;      ///< [-] below: free; between: unknown
  Mode mode = Mode::trinary;
  bool averages_alpha = true;  ///< in mode trinary; false: pixels more than half transparent are unknown
};

/// @param file name for errors; `image` is relative to its folder
/// @throws base::InputError with file and line, also for YAML worlds of other simulators
RosMap read_ros_map_file(const std::string& file, const std::string& text, std::vector<Warning>& warnings);

}  // namespace sf::world
