#pragma once
// The words a world file may use: which we read, which we know but do not model, and what a misspelt one may have
// meant.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sf::world {

/// Where a property stands.
enum class KeyScope {
  world,
  model,
  position,
  laser,
  ranger,
  light,
  sensor,
  block,
  device,
  sensing,
  road,
  path,
  unmodelled
};

/// How a type of the world file is understood.
enum class EntityKind { model, position, laser, ranger, light, road, path, unmodelled, ignored, unknown };

EntityKind entity_kind(std::string_view type);

/// True for types that Stage gives no body of their own (rangers, bumpers, ...): without blocks they are invisible.
bool has_no_body(std::string_view type);

/// All types we know by name, for suggestions.
std::vector<std::string_view> known_types();

/// True for keys that are read there, and for Stage's own keys that are not modelled. Indices do not matter.
/// @param own further keys valid there, with empty indices.
bool is_known_key(KeyScope where, std::string_view key, std::span<const std::string_view> own = {});

/// `; did you mean 'x'?` or nothing: the nearest of the keys valid there.
std::string suggest_key(KeyScope where, std::string_view key, std::span<const std::string_view> own = {});

/// `; did you mean 'x'?` for the nearest candidate within two slips (one, for words of up to four letters), else
/// nothing.
std::string suggest(std::string_view word, std::span<const std::string_view> candidates);

/// Optimal string alignment distance: insertions, deletions, substitutions and swaps of neighbours.
std::uint32_t edit_distance(std::string_view a, std::string_view b);

}  // namespace sf::world
