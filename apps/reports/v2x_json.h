#pragma once
// V2X frames as JSON: the names of J2735, enumerations and choices by name, bit strings as "0010", octets as
// hexadecimal digits. nlohmann/json stays in the source.

#include <functional>
#include <string>

#include "v2x/frame.h"

namespace sf::apps {

/// On one line, without its end.
std::string json_of(const v2x::Frame& frame);

/// The frames of a text, in order: JSON objects one after another (JSON Lines among them), or an array of them.
/// @throws base::InputError with file, line and component for the first fault; frames before it were given to `take`
void read_frames(const std::string& file, const std::string& text, const std::function<void(const v2x::Frame&)>& take);

}  // namespace sf::apps
