#pragma once
// A world file while its tokens are being read into a tree.

#include <algorithm>
#include <map>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "world/stage/document.h"
#include "world/stage/tokenizer.h"

namespace sf::world {

/// Rows of an entity's properties.
using KeyRows = std::unordered_map<std::string, std::uint32_t>;

struct ParseState {
  Document document;
  KeyRows root_rows;
  std::map<std::string, Entity, std::less<>> macros;
  std::vector<std::string> open_files;  ///< the chain of includes being read
  std::uint32_t file = 0;               ///< row of the file being read
  std::vector<Token> tokens;
  std::size_t at = 0;
  std::uint32_t weight = 0;  ///< of everything read so far
  int includes = 0;
};

inline const Token& now(const ParseState& r) { return r.tokens[r.at]; }
inline const Token& next(const ParseState& r) { return r.tokens[std::min(r.at + 1, r.tokens.size() - 1)]; }
inline SourceLocation location(const ParseState& r, const Token& token) { return {r.file, token.line}; }

/// @throws base::InputError, always, with the file being read.
[[noreturn]] void fail(const ParseState& r, int line, const std::string& message);
void warn(ParseState& r, int line, std::string message);

/// A token as an error quotes it.
std::string shown(const Token& token);

/// Reads `key value` and moves on. @throws base::InputError when there is no value.
Property read_property(ParseState& r);

/// Of two equal properties the last wins, with a warning when both stand in the same parentheses.
/// @param rows of all that the entity has
/// @param written the keys of these parentheses so far.
/// @throws base::InputError for two equal indices: an element would be lost.
void add_property(ParseState& r, Entity& entity, KeyRows& rows, std::unordered_set<std::string>& written,
                  Property property);

/// Makes `find` quick where there are many properties.
void sort_keys(Entity& entity);

}  // namespace sf::world
