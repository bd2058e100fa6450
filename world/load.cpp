#include <algorithm>
#include <filesystem>

#include "world/entities.h"
#include "world/ros_map.h"
#include "world/stage.h"
#include "world/world.h"

namespace sf::world {

World load_world(const std::string& file, const LoadOptions& options) {
  std::string ending = std::filesystem::path(file).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending == ".yaml" || ending == ".yml") return load_ros_map(file, options);
  return build_world(file, read_text(file), options);
}

}  // namespace sf::world
