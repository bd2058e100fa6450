#pragma once
// Words of world files: modelled words (keys with one value: world/fields.h), and words that are known but not
// modelled.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sf::world {

/// The entity that contains a property.
enum class KeyScope {
  world,
  model,
  position,
  light,
  sensor,
  block,
  device,
  sensing,
  road,
  path,
  shape,
  terrain,
  unmodelled
};

/// How a type of the world file is treated.
enum class EntityKind { model, position, light, road, path, shape, terrain, unmodelled, ignored, unknown };

EntityKind entity_kind(std::string_view type);

/// Returns true for types that have no body of their own in Stage (rangers, bumpers, ...): without blocks they are
/// invisible.
bool has_no_body(std::string_view type);

/// Returns all known types, for suggestions.
std::vector<std::string_view> known_types();

/// Returns true for keys that are read in `where`, and for Stage's own keys that are not modelled. Ignores indices.
/// @param own further keys valid there, with empty indices
bool is_known_key(KeyScope where, std::string_view key, std::span<const std::string_view> own = {});

/// Returns a warning about a known Stage key that is not modelled but has an effect in Stage; empty: none.
std::string_view unmodelled_effect(std::string_view key);

/// Returns `; did you mean 'x'?` with the nearest valid key, or an empty text.
std::string suggest_key(KeyScope where, std::string_view key, std::span<const std::string_view> own = {});

}  // namespace sf::world
