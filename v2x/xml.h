#pragma once
// Frames as XML, by the XML encoding rules of ASN.1 (X.693) in their usual form: names of J2735, no item names in lists
// of choices and enumerations, octets as hexadecimal digits.

#include <string>

#include "v2x/frame.h"

namespace sf::v2x {

/// Returns `<MessageFrame>` with its content, indented by two spaces per level.
/// @param depth enclosing levels
std::string xml_of(const Frame& frame, unsigned depth = 0);

}  // namespace sf::v2x
