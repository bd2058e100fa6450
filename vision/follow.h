#pragma once
// Settings for following tags from camera to camera: the section [follow] of testbed files.

#include <cstdint>
#include <glm/ext/vector_double2.hpp>
#include <set>
#include <string>

#include "world/toml_reader.h"

namespace sf::vision {

/// An event that starts or stops following, as written in testbed files.
struct FollowEvent {
  enum class Kind {
    none,    ///< "" : at once, as a start; never, as a stop
    time,    ///< "at 5 s": once, at that time of the images
    enters,  ///< "tag 3 enters [x y width height]": it is seen in the rectangle, and was not when last seen
    leaves,  ///< "tag 3 leaves [x y width height]": it is seen outside, and was inside when last seen
  };
  Kind kind = Kind::none;
  double time = 0.0;      ///< [s]
  std::uint32_t tag = 0;  ///< of `enters`, `leaves`
  glm::dvec2 low, high;   ///< [m] corners of the rectangle in the world; its first ones are x, y
  std::string text;       ///< as in the file
  int line = 0;           ///< in the file

  bool watches_tag() const { return kind == Kind::enters || kind == Kind::leaves; }
  bool contains(glm::dvec2 p) const { return p.x >= low.x && p.y >= low.y && p.x <= high.x && p.y <= high.y; }
};

struct FollowSettings {
  static constexpr std::size_t kMaxTags = 256;

  std::set<std::uint32_t> tags;  ///< 1 to `kMaxTags`
  double margin = 0.05;          ///< [m] added to the uncertainty of a tag's place
  double speed = 5.0;            ///< [m/s] bound of the tags' speed
  double search = 1.0;           ///< [s] after which a tag is searched for in all cameras
  FollowEvent start, stop;
};

/// @throws base::InputError with file and line for unknown keys and values out of range
FollowSettings read_follow(const world::TomlReader& reader, const world::TomlNode& table);

/// Parses ids such as "7,9". @return empty for another form
std::set<std::uint32_t> read_tags(const std::string& text);

}  // namespace sf::vision
