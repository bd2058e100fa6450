#pragma once
// Colour names of X11, as world files use them.

#include <cstdint>
#include <optional>
#include <string_view>

namespace sf::world {

/// 0xFFRRGGBB. Case and blanks do not matter (`steel blue`, `SteelBlue`); `gray0` .. `gray100` and the darker variants
/// `red1` .. `red4` are known.
std::optional<std::uint32_t> color_of(std::string_view name);

}  // namespace sf::world
