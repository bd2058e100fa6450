#include <algorithm>
#include <filesystem>

#include "base/error.h"
#include "base/files.h"
#include "world/ros_map.h"
#include "world/stage/stage.h"
#include "world/world.h"

namespace sf::world {

World load_world(const std::string& file, const LoadOptions& options) {
  std::string ending = std::filesystem::path(file).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (is_ros_map(file)) return load_ros_map(file, options);
  if (ending == ".rndf" || ending == ".rdf" || ending == ".mdf")
    throw base::InputError(file, 0, "is not a world, but can be part of one: a world file with road( rndf \"FILE\" )");
  if (ending == ".toml")
    throw base::InputError(file, 0,
                           "is not a world: scenarios go with `run` and `test`, sweeps with `sweep`, testbeds with "
                           "`vps`; expected a world file (.world) or a ROS map (.yaml)");
  return build_world(file, base::read_text(file), options);
}

}  // namespace sf::world
