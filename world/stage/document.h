#pragma once
// A Stage world file as a tree: includes read, macros expanded, every property with the place it was written at.

#include <cstdint>
#include <string>
#include <vector>

#include "world/world.h"

namespace sf::world {

/// Where something was written.
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
  std::vector<Value> values;  ///< one, or as many as the tuple has
  bool is_tuple = false;
  SourceLocation at;
};

/// `type( properties and children )` after macro expansion. Keys are unique: the last one written won.
struct Entity {
  std::string word;  ///< what the file says, e.g. `pioneer2dx`
  std::string type;  ///< what its macros come down to, e.g. `position`
  SourceLocation at;
  std::vector<Property> properties;
  std::vector<Entity> children;
  std::vector<std::uint32_t> by_key;  ///< rows of `properties` in the order of their keys, where they are many
  std::uint32_t depth = 1;            ///< levels of this tree, itself included; at most 64
  std::uint32_t weight = 1;  ///< entities, properties, values and stretches of text in this tree, itself included
};

struct Document {
  std::vector<std::string> files;   ///< [0] is the world file
  Entity root;                      ///< the world's own properties and top-level entities
  std::vector<std::string> macros;  ///< names that were defined, sorted: to suggest from
  std::vector<Warning> warnings;
};

/// Parses `text`, the content of the world file `file` (which need not exist: it names errors, and includes are looked
/// for beside the including file, beside `file`, then along $STAGEPATH).
/// @throws base::InputError with file and line.
Document parse(const std::string& file, const std::string& text);

/// `name` as a path: itself when absolute, else the first that exists beside `from`, beside the world file, along
/// $STAGEPATH. Empty when there is none.
std::string find_file(const Document& document, SourceLocation from, const std::string& name);

/// The whole of a file. @throws base::InputError when it is not there, no regular file (a folder, a device, a pipe),
/// empty, larger than `most` bytes, or cannot be read to its end.
std::string read_bytes(const std::string& file, std::size_t most);
/// Likewise of a text, which says something.
std::string read_text(const std::string& file, std::size_t most = 64u << 20);

/// The property of that exact key, or null. Lives as long as the entity.
const Property* find(const Entity& entity, std::string_view key);

}  // namespace sf::world
