#pragma once
// Families of tags by the names of testbed files (docs/vps.md), upright as their authors print them.
//
// OpenCV prints AprilTags turned by 180 degrees relative to AprilRobotics' images and library. A name that ends with
// "_opencv" selects OpenCV's orientation.

#include <memory>
#include <string>

#include "vision/opencv.h"

namespace sf::vision {

/// @throws base::InputError for an unknown family, or an id that it lacks
TagPattern family_pattern(const std::string& family, std::uint32_t id);
/// Returns the number of tags; ids start at 0. @throws base::InputError for an unknown family
std::uint32_t family_size(const std::string& family);
/// @throws base::InputError for an unknown family
std::unique_ptr<TagFinder> make_family_finder(const std::string& family);

/// Returns one sentence for the report where libraries differ in the orientation of the family's tags; else empty.
std::string family_orientation(const std::string& family);

}  // namespace sf::vision
