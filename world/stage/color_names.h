#pragma once
// X11 colour names, as used in world files.

#include <cstdint>
#include <optional>
#include <string_view>

namespace sf::world {

/// Returns 0xFFRRGGBB. Ignores case and blanks (`steel blue`, `SteelBlue`). Accepts `gray0` .. `gray100` and the darker
/// variants `red1` .. `red4`.
std::optional<std::uint32_t> color_of(std::string_view name);

}  // namespace sf::world
