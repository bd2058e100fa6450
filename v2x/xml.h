#pragma once
// Frames as XML, by the XML encoding rules of ASN.1 (X.693) as usual tools write them: names of J2735, lists of choices
// and enumerations without names of items, octets as hexadecimal digits.

#include <string>

#include "v2x/frame.h"

namespace sf::v2x {

/// `<MessageFrame>` and all within, indented by two blanks a level. @param depth levels around it
std::string xml_of(const Frame& frame, unsigned depth = 0);

}  // namespace sf::v2x
