#pragma once
// The functions of vision/opencv.h about tags.

#include "vision/opencv.h"

namespace sf::vision {

TagPattern tag_pattern(const std::string& dictionary, std::uint32_t id);
std::uint32_t tag_count(const std::string& dictionary);
std::unique_ptr<TagFinder> make_tag_finder(const std::string& dictionary);

}  // namespace sf::vision
