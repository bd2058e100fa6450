// libFuzzer target: any bytes as the YAML of a ROS map. Its picture is looked up in a folder that does not exist, so
// that the whole file is read and none becomes a world.

#include <cstdint>
#include <cstdlib>
#include <string>

#include "base/error.h"
#include "world/ros_map.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr const char* kFile = "/nowhere/fuzz.yaml";
  try {
    sf::world::build_ros_map(kFile, std::string(reinterpret_cast<const char*>(data), size), {});
  } catch (const sf::base::InputError& error) {
    if (!std::string_view(error.what()).starts_with(kFile)) std::abort();
  }
  return 0;
}
