#pragma once
// Robot names on the command line.

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sf::apps {

/// Splits `texts`, each "NAME" or "NAME,NAME,...", into names. From left to right, takes the longest name in `known`
/// that ends at a comma or the end of the text. If none matches, takes the text up to the next comma, so that an error
/// message can name it.
std::vector<std::string> robot_names(const std::vector<std::string>& texts, std::span<const std::string_view> known);

}  // namespace sf::apps
