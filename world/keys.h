#pragma once
// Words of world files: modelled words (keys of one value: world/fields.h), and words known but not modelled.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sf::world {

/// The entity in which a property stands.
enum class KeyScope { world, model, position, light, sensor, block, device, sensing, road, path, unmodelled };

/// Treatment of a type of the world file.
enum class EntityKind { model, position, light, road, path, unmodelled, ignored, unknown };

EntityKind entity_kind(std::string_view type);

/// True for types that Stage gives no body of their own (rangers, bumpers, ...): without blocks they are invisible.
bool has_no_body(std::string_view type);

/// All known types, for suggestions.
std::vector<std::string_view> known_types();

/// True for keys that are read in `where`, and for Stage's own keys that are not modelled. Indices do not matter.
/// @param own further keys valid there, with empty indices.
bool is_known_key(KeyScope where, std::string_view key, std::span<const std::string_view> own = {});

/// A warning about a key of Stage's that is known, not modelled, and changes what happens in Stage; empty: none.
std::string_view unmodelled_effect(std::string_view key);

/// `; did you mean 'x'?` with the nearest of the keys valid there, or an empty text.
std::string suggest_key(KeyScope where, std::string_view key, std::span<const std::string_view> own = {});

}  // namespace sf::world
