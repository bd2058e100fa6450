#pragma once
// State of the parser that converts tokens to a tree.

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
  std::vector<std::string> open_files;  ///< the chain of open includes
  std::uint32_t file = 0;               ///< row of the file being read
  std::vector<Token> tokens;
  std::size_t at = 0;
  std::uint32_t weight = 0;  ///< total weight so far (see Entity::weight)
  int includes = 0;
};

inline const Token& now(const ParseState& r) { return r.tokens[r.at]; }
inline const Token& next(const ParseState& r) { return r.tokens[std::min(r.at + 1, r.tokens.size() - 1)]; }
inline SourceLocation location(const ParseState& r, const Token& token) { return {r.file, token.line}; }

/// Throws base::InputError with the name of the current file.
[[noreturn]] void fail(const ParseState& r, int line, const std::string& message);
void warn(ParseState& r, int line, std::string message);

/// Returns a token as quoted in errors.
std::string shown(const Token& token);

/// Reads `key value` and advances. @throws base::InputError if there is no value
Property read_property(ParseState& r);

/// Adds a property. It overrides an equal one, with a warning if both are in the same parentheses.
/// @param rows rows of all properties of the entity
/// @param written keys in these parentheses so far
void add_property(ParseState& r, Entity& entity, KeyRows& rows, std::unordered_set<std::string>& written,
                  Property property);

/// Adds properties whose numbered key (`spose[0]`) was already written in the same parentheses. Where their count
/// (`scount`) leaves numbers free for all repeats of a key, they take the smallest free ones in order of appearance;
/// otherwise each overrides the one before. Both are warnings. Call it after all other properties of the entity.
void add_repeats(ParseState& r, Entity& entity, KeyRows& rows, std::unordered_set<std::string>& written,
                 std::vector<Property> repeats);

/// Sorts the keys of an entity with many properties, for a fast `find`.
void sort_keys(Entity& entity);

}  // namespace sf::world
