#pragma once
// A camera's pose in the world from images of tags whose places were surveyed.

#include <string>
#include <vector>

#include "vision/opencv.h"
#include "vision/testbed.h"

namespace sf::vision {

inline constexpr std::size_t kMaxPlacementImages = 200;  ///< of a folder or a video; the rest is not read
inline constexpr std::size_t kLivePlacementImages = 15;  ///< of a device

/// A surveyed tag against the image, with the camera's pose as found.
struct TagResidual {
  std::uint32_t id = 0;
  std::size_t images = 0;  ///< in which it was seen
  double pixels = 0.0;     ///< [px] RMS distance of its corners (its centre, without a heading) from their projections
  double metres = 0.0;     ///< [m] distance of its centre from the surveyed one, on the plane at its height
  /// [px] Residual of all other tags, with the camera placed by them alone; nothing where they do not determine it. One
  /// wrong place spoils the residuals of all tags, and this one of all but its own.
  std::optional<double> without;
};

struct Placement {
  Camera camera;
  double residual = 0.0;              ///< [px] RMS of all points
  std::vector<TagResidual> tags;      ///< that were seen, by id
  std::vector<std::uint32_t> unseen;  ///< surveyed tags that are in no image
};

/// Places one camera of the testbed. The means over all images count, in which nothing may move. Corners are where
/// lines through the tags' edges meet, to a few hundredths of a pixel.
/// @param from name of the source, for errors
/// @throws base::InputError for images of another size than the camera's, without surveyed tags in the testbed file,
/// and where those in sight do not determine a pose: fewer than four points (a tag with a heading has four), or all
/// nearly on one line
Placement place_camera(const Testbed& testbed, const Camera& camera, ImageSource& images, const std::string& from);

}  // namespace sf::vision
