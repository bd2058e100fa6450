#pragma once
// Text files that commands write at their end.

#include <string>
#include <string_view>

namespace sf::apps {

/// Checks, before a long computation, that the file can be written. Does not change its content.
/// @throws base::InputError naming the path
void check_writable(const std::string& path);
/// Replaces the file. @throws base::InputError naming the path
void write_text(const std::string& path, std::string_view text);

}  // namespace sf::apps
