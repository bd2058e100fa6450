#pragma once
// Detects files that are not Stage worlds: worlds of other simulators, pictures, maps and program settings. They are
// recognised by content. The error names the format and says how its geometry can be used.

#include <string>
#include <string_view>

namespace sf::world {

/// @param text beginning of a file that is about to be read as a Stage world
/// @throws base::InputError if it is of another known kind
void refuse_foreign(const std::string& file, std::string_view text);

/// Throws base::InputError: "is a world of PROGRAM; HOW"
[[noreturn]] void refuse_world_of(const std::string& file, int line, std::string_view program, std::string_view how);

}  // namespace sf::world
