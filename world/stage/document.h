#pragma once
// A Stage world file as a tree: includes read, macros expanded, each property with its place in the file.

#include <cstdint>
#include <string>
#include <vector>

#include "world/world.h"

namespace sf::world {

inline constexpr std::size_t kMaxWarnings = 10'000;  ///< of the grammar and of keys; further warnings are dropped

/// A place in a file.
struct SourceLocation {
  std::uint32_t file = 0;  ///< row in `Document::files`
  int line = 0;            ///< 1-based
};

/// A number or a string.
struct Value {
  bool is_text = false;
  double number = 0.0;  ///< finite
  std::string text;     ///< as written
};

struct Property {
  std::string key;            ///< with its index, e.g. `point[3]`
  std::vector<Value> values;  ///< one, or one per element of the tuple
  bool is_tuple = false;
  SourceLocation at;
};

/// `type( properties and children )` after macro expansion. Keys are unique: the last one written overrides earlier
/// ones.
struct Entity {
  std::string word;  ///< as written, e.g. `pioneer2dx`
  std::string type;  ///< the type after macro expansion, e.g. `position`
  SourceLocation at;
  std::vector<Property> properties;
  std::vector<Entity> children;
  std::vector<std::uint32_t> by_key;  ///< rows of `properties` in order of keys, for entities with many properties
  std::uint32_t depth = 1;            ///< levels of this tree, including itself; at most 64
  std::uint32_t weight =
      1;  ///< number of entities, properties, values and pieces of text in this tree, including itself
};

struct Document {
  std::vector<std::string> files;   ///< [0] is the world file
  std::string ros_map;              ///< included YAML file; empty: none
  SourceLocation ros_map_at;        ///< of its include
  Entity root;                      ///< the world's own properties and top-level entities
  std::vector<std::string> macros;  ///< defined names, sorted, for suggestions
  std::vector<std::string> robots;  ///< the names in `macros` that define robots
  std::vector<Warning> warnings;
};

/// Parses `text`, the content of the world file `file`. The file need not exist: its name is used for errors, and its
/// folder to search for includes (the including file's folder, the folder of `file`, $STAGEPATH, then the installed
/// worlds).
/// @throws base::InputError with file and line
Document parse(const std::string& file, const std::string& text);

/// Returns the path of `name`: itself if absolute, or else the first existing file in the folder of `from`, in the
/// folder of the world file, along $STAGEPATH, or among the installed worlds. Empty if none exists.
std::string find_file(const Document& document, SourceLocation from, const std::string& name);

/// Stage searches the folder of the world file first. Returns the file that Stage reads instead of `found`; empty if it
/// is the same.
std::string file_in_stage(const Document& document, const std::string& name, const std::string& found);

/// Returns the property with exactly that key, or null. Valid for the lifetime of the entity.
const Property* find(const Entity& entity, std::string_view key);

}  // namespace sf::world
