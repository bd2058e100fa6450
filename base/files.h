#pragma once
// Whole files from outside, of limited size.

#include <cstddef>
#include <string>

namespace sf::base {

/// The whole content of a file. @throws InputError when the file is missing, not a regular file (a folder, a
/// device, a pipe), empty, larger than `most` bytes, or not readable to its end.
std::string read_bytes(const std::string& file, std::size_t most);
/// Likewise for a text. @throws InputError also for a text without content.
std::string read_text(const std::string& file, std::size_t most = 64u << 20);

}  // namespace sf::base
