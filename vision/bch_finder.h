#pragma once
// Finds ARToolKitPlus's id-based markers with BCH in images.

#include <memory>

#include "vision/opencv.h"

namespace sf::vision {

/// Returns the cells of a marker with the black border of one cell that ARToolKitPlus's images have.
/// @param id below `kBchIds`
TagPattern bch_pattern(std::uint32_t id);

/// Markers with a border of one cell ("thin", an eighth of the side) or three cells ("standard", a quarter) are found.
std::unique_ptr<TagFinder> make_bch_finder();

}  // namespace sf::vision
