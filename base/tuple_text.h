#pragma once
// Descriptions of tuples, such as "[x y yaw]".

#include <cstddef>
#include <string_view>

namespace sf::base {

/// Returns how many numbers the longest tuple in a description has: 3 for "[x y], or [x y yaw]". A description without
/// a tuple, or with "[x ...]", allows any number.
std::size_t numbers_in(std::string_view description);

}  // namespace sf::base
