#pragma once
// Robots named on the command line.

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sf::apps {

/// The names in `texts`, each "NAME" or "NAME,NAME,...": from left to right the longest that is one of `known`, up to a
/// comma or the end. A part that begins none is taken up to its comma, for the message that refuses it.
std::vector<std::string> robot_names(const std::vector<std::string>& texts, std::span<const std::string_view> known);

}  // namespace sf::apps
