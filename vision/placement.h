#pragma once
// Computes a camera's pose in the world from images of tags at surveyed positions.

#include <string>
#include <vector>

#include "vision/opencv.h"
#include "vision/testbed.h"

namespace sf::vision {

inline constexpr std::size_t kMaxPlacementImages = 200;  ///< read from a folder or a video; further images are ignored
inline constexpr std::size_t kLivePlacementImages = 15;  ///< read from a device

/// Deviation of a surveyed tag from the image, for the computed camera pose.
struct TagResidual {
  std::uint32_t id = 0;
  std::size_t images = 0;  ///< number of images in which it was seen
  double pixels = 0.0;     ///< [px] RMS distance of its corners (without a heading: its centre) from their projections
  double metres = 0.0;     ///< [m] distance of its centre from the surveyed position, on the plane at its height
  /// [px] Residual of all other tags for a camera placed by them alone; nullopt if they do not determine its pose. One
  /// wrong position increases the residuals of all tags, but it increases this value for all tags except its own.
  std::optional<double> without;
};

struct Placement {
  Camera camera;
  double residual = 0.0;              ///< [px] RMS over all points
  std::vector<TagResidual> tags;      ///< seen tags, sorted by id
  std::vector<std::uint32_t> unseen;  ///< surveyed tags that are in no image
};

/// Computes the pose of one camera of the testbed. Averages over all images, in which nothing may move. Corners are
/// intersections of lines through the tags' edges, accurate to a few hundredths of a pixel.
/// @param from name of the source, for errors
/// @throws base::InputError if the images do not have the camera's size, the testbed file has no surveyed tags, or the
/// visible ones do not determine a pose: fewer than four points (a tag with a heading has four), or all nearly on one
/// line
Placement place_camera(const Testbed& testbed, const Camera& camera, ImageSource& images, const std::string& from);

}  // namespace sf::vision
