#pragma once
// The parts of a camera's image in which a tag may be seen.

#include <optional>

#include "vision/tag_detector.h"

namespace sf::vision {

/// A disc at some height that contains a tag's centre, or a rectangle.
struct TagPlace {
  glm::dvec2 center;          ///< [m]
  glm::dvec2 reach;           ///< [m] >= 0: half of its extent along x and y; a disc's is that of its bounding square
  double height = 0.0;        ///< [m] of the tag
  double height_error = 0.0;  ///< [m] >= 0
};

/// Adds the part of the image that contains every tag of `mount` in `place` with its white border and
/// `TagFinder::kRegionMargin`. Adds nothing if the camera cannot see a complete tag there.
/// @param cells along the side of the tag's code with its black border
void add_region(const Camera& camera, const TagPlace& place, const TagMount& mount, int cells, Search& search);

/// Merges regions that overlap, and replaces them by the whole image if they cover most of it.
void merge_regions(const Intrinsics& image, Search& search);

}  // namespace sf::vision
