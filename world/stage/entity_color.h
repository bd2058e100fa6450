#pragma once
// Colours of models and fields of view.

#include "world/stage/properties.h"

namespace sf::world {

/// Returns the colour of the property `key`, or else that of `color_rgba`, or else the fallback. An unknown name gives
/// the fallback and a warning. `random` is a fixed function of `seed`.
std::uint32_t entity_color(StageContext& context, const Entity& entity, std::string_view key, std::uint32_t fallback,
                           std::uint32_t seed);

}  // namespace sf::world
