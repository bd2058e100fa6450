#pragma once
// V2X frames as JSON: names as in J2735, enumerations and choices by name, bit strings as "0010", octets as hexadecimal
// digits. Only the source includes nlohmann/json.

#include <functional>
#include <string>

#include "v2x/frame.h"

namespace sf::apps {

/// Returns the frame on one line, without a line end.
std::string v2x_frame_json(const v2x::Frame& frame);

/// Parses the frames in a text, in order: successive JSON objects (including JSON Lines) or an array of objects.
/// @throws base::InputError with file, line and component for the first error; the frames before it were passed to
/// `take`
void read_frames(const std::string& file, const std::string& text, const std::function<void(const v2x::Frame&)>& take);

}  // namespace sf::apps
