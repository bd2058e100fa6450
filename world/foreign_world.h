#pragma once
// Files that are not Stage worlds: worlds of other simulators, pictures, maps and settings of programs.
// Each is recognised by its content and refused by its name, with the way in which its geometry can be used.

#include <string>
#include <string_view>

namespace sf::world {

/// @param text the beginning of a file that is about to be read as a Stage world
/// @throws base::InputError when it is of a known other kind
void refuse_foreign(const std::string& file, std::string_view text);

/// @throws base::InputError, always: "is a world of PROGRAM; HOW"
[[noreturn]] void refuse_world_of(const std::string& file, int line, std::string_view program, std::string_view how);

}  // namespace sf::world
