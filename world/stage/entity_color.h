#pragma once
// Colours of models and fields of view.

#include "world/stage/properties.h"

namespace sf::world {

/// The colour that `key` names, or that `color_rgba` gives when there is none; the fallback when there is neither or
/// the name is unknown (with a warning). `random` is a fixed function of `seed`.
std::uint32_t entity_color(StageContext& context, const Entity& entity, std::string_view key, std::uint32_t fallback,
                           std::uint32_t seed);

}  // namespace sf::world
