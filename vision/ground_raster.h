#pragma once
// The ground ahead of a robot, seen from above: inverse perspective mapping (H. Mallot et al., "Inverse perspective
// mapping simplifies optical flow computation and obstacle detection", 1991) of a camera with any lens.
//
// Frames: R robot (x ahead, y left, z up, origin on the ground), C camera as in sensors/camera.h (x along the optical
// axis, y to the left of the image, z up).

#include <cstdint>
#include <glm/ext/vector_double2.hpp>
#include <vector>

#include "base/lens.h"
#include "base/rigid_transform.h"
#include "vision/image.h"

namespace sf::vision {

/// Square cells, row by row, the farthest row first, each from left to right.
struct GroundRaster {
  double near = 0.2, far = 1.2;  ///< [m] ahead of the robot's origin, near < far
  double side = 0.8;             ///< [m] to the left and to the right, > 0
  double cell = 0.005;           ///< [m] > 0

  int rows() const { return static_cast<int>((far - near) / cell + 0.5); }
  int columns() const { return 2 * static_cast<int>(side / cell + 0.5); }
  /// Returns the place [m] of a cell's middle in R. @param column may be a fraction
  glm::dvec2 place(double column, int row) const {
    return {far - (row + 0.5) * cell, (0.5 * columns() - column - 0.5) * cell};
  }
};

inline constexpr glm::dvec2 kUnseen{-1.0, -1.0};

/// Returns the pixel of each cell's middle; kUnseen where it is not in the image.
/// @param X_RC pose of the camera @param width, height [px] of the image
std::vector<glm::dvec2> pixels_of(const GroundRaster& raster, const base::Lens& lens, const base::RigidTransform& X_RC,
                                  unsigned width, unsigned height);

/// Lines to find, in metres on the ground.
struct PaintLines {
  double gap = 0.025;      ///< gaps up to this width do not divide a line: double lines are one
  double widest = 0.1;     ///< of a line, along a row of the raster
  double contrast = 0.15;  ///< least brightness above that of the ground beside it, in parts of the latter
};

/// Returns the middles [m] in R of all painted lines, row by row, those at the borders of the view excepted.
/// @param ground, paint results of PaintFinder::find
std::vector<glm::dvec2> paint_points(const GroundRaster& raster, const PaintLines& lines, const Image& ground,
                                     const Image& paint);

}  // namespace sf::vision
