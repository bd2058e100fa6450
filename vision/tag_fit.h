#pragma once
// Fits a tag's pose on a horizontal plane to its outline in an image.
//
// Along the four sides of the outline, the edge between the black border and the white around it is located to a small
// fraction of a pixel, where the grey value crosses the mean of black and white. All edge points are back-projected to
// the plane at the tag's height, and one square is fitted to them by least squares: position, heading and side.
// Distorted lines and oblique views need no special case.
//
// With a known side, height and tilt follow from the same edge points.

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

/// Interpolates bilinearly; border pixels continue outside of the image. @param image grey, at least 2 x 2
double grey_at(const Image& image, glm::dvec2 pixel);

/// Finds about 30 edge points per side; none on sides without contrast. @param cells along a side of the tag
void find_edges(const Image& image, const TagOutline& outline, int cells, std::vector<EdgePoint>& out);

/// A tag as seen by one camera.
struct TagFit {
  base::Pose X_WT;        ///< pose of the tag in the world; z: the height of the plane
  double side = 0.0;      ///< [m] measured; a wrong height or a wrong specified side changes its ratio to the latter
  double residual = 0.0;  ///< [m] RMS distance of the edge points from the square
  double pixel = 0.0;     ///< [m] size of a pixel on the plane
  double row = 0.0;       ///< [px] of the tag's centre in the image
  int points = 0;         ///< number of edge points used
  double height_sigma = 0.0;  ///< [m] standard deviation of z if it was measured; 0: z is the given height
  /// [rad] R_WT = Rz(yaw) Ry(pitch) Rx(roll); 0: taken as horizontal
  double roll = 0.0, pitch = 0.0;
  double tilt_sigma = 0.0;  ///< [rad] standard deviation of roll and pitch if they were measured; else 0
};

/// Fits a square to edge points. Removes points farther off than three times the median distance.
/// @return nullopt if fewer than three sides have points, or the points do not form a square
std::optional<TagFit> fit_tag(const Camera& camera, std::span<const EdgePoint> points, double height);

/// Returns the horizontal tag of side `side` [m] in the same image: the height at which the square of `flat` has that
/// side. `height_sigma` includes the noise of the edges and `kEdgeBias`, but not errors of the calibration.
TagFit at_measured_height(const Camera& camera, const TagFit& flat, double side);

/// Fits position and orientation of a tag of side `side` [m], starting from a horizontal one. A small tag has a second
/// orientation with almost the same image, mirrored at the line of sight. If the edges do not decide, returns the one
/// nearer to horizontal, and `tilt_sigma` is the angle between both.
/// @return nullopt if the points do not form a square
std::optional<TagFit> fit_tag_in_space(const Camera& camera, std::span<const EdgePoint> points, const TagFit& start,
                                       double side);

/// [px] Standard deviation of the common outward shift of all edges of a tag, due to blur and the camera's gamma.
inline constexpr double kEdgeBias = 0.03;

}  // namespace sf::vision
