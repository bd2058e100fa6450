#pragma once
// Robots from URDF (Unified Robot Description Format, wiki.ros.org/urdf), as the plug-in reads them.

#include <glm/mat4x4.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sf::world {

/// A shape of a link.
struct UrdfShape {
  enum class Kind : std::uint8_t { mesh, box, cylinder, sphere };
  Kind kind = Kind::mesh;
  std::string file;   ///< of a mesh, as written
  glm::dvec3 size{};  ///< [m] box: its sides; cylinder: [radius radius length]; sphere: its radius, thrice; mesh: scale
  glm::dmat4 X{1.0};  ///< its frame in the robot's, with all joints at 0
  std::optional<glm::dvec3> color = {};  ///< of a material without texture: linear, as Material::color
};

struct UrdfLink {
  std::string name;
  std::vector<UrdfShape> visual, collision;
};

struct UrdfRobot {
  std::vector<UrdfLink> links;
  std::size_t movable = 0;    ///< joints that are not fixed
  std::string parser_errors;  ///< one per element that the parser skipped; empty: none
};

/// The interface of the plug-in. `read` throws base::InputError with the parser's errors.
struct UrdfPlugin {
  UrdfRobot (*read)(const std::string& file, const std::string& text);
};
/// Name of the plug-in's only symbol: `extern "C" const UrdfPlugin sensorfarm_urdf`.
inline constexpr const char* kUrdfSymbol = "sensorfarm_urdf";

}  // namespace sf::world
