#pragma once
// Fits a tag's pose on a horizontal plane to its outline in an image.
//
// Along the four sides of the outline, the edge between the black border and the white around it is located to a small
// fraction of a pixel, where the grey value crosses the mean of black and white. All edge points are back-projected to
// the plane at the tag's height, and one square is fitted to them by least squares: position, heading and side.
// Distorted lines and oblique views need no special case.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/pose.h"
#include "vision/camera.h"
#include "vision/image.h"
#include "vision/opencv.h"

namespace sf::vision {

/// A point on the edge of a tag.
struct EdgePoint {
  glm::dvec2 pixel;
  int side = 0;  ///< 0: upper, 1: right, 2: lower, 3: left of the printed tag
};

/// Finds about 30 edge points per side; none on sides without contrast. @param cells along a side of the tag
void find_edges(const Image& image, const TagOutline& outline, int cells, std::vector<EdgePoint>& out);

/// A tag as seen by one camera.
struct TagFit {
  base::Pose X_WT;        ///< pose of the tag in the world; z: the height of the plane
  double side = 0.0;      ///< [m] measured; a wrong height or a wrong specified side changes its ratio to the latter
  double residual = 0.0;  ///< [m] RMS distance of the edge points from the square
  double pixel = 0.0;     ///< [m] size of a pixel on the plane
  double row = 0.0;       ///< [px] of the tag's centre in the image
};

/// Fits a square to edge points. Removes points farther off than three times the median distance.
/// @return nullopt if fewer than three sides have points, or the points do not form a square
std::optional<TagFit> fit_tag(const Camera& camera, std::span<const EdgePoint> points, double height);

}  // namespace sf::vision
