#include "vision/calibration.h"

#include <fmt/format.h>

#include "base/error.h"

namespace sf::vision {

namespace {

/// Totals of the images read so far, and their limits.
struct Extent {
  std::string from;
  int width = 0, height = 0;  ///< [px] of all images
  std::size_t images = 0, corners = 0;

  void check_images(std::size_t count) const {
    if (count > kMaxCalibrationImages)
      throw base::InputError(
          from, 0, fmt::format("has more than {} images; expected fewer, all different", kMaxCalibrationImages));
  }
  void count(const Image& image) {
    check_images(++images);
    if (image.pixels.empty()) return;
    if (width == 0) width = image.width, height = image.height;
    if (image.width != width || image.height != height)
      throw base::InputError(from, 0,
                             fmt::format("image {} is {} x {}, but the first is {} x {}; expected images of one camera",
                                         images, image.width, image.height, width, height));
    if (static_cast<std::int64_t>(images) * width * height > kMaxCalibrationPixels)
      throw base::InputError(from, 0,
                             fmt::format("has images of more than {} Mpx in all; expected fewer or smaller ones",
                                         kMaxCalibrationPixels >> 20));
  }
  void count_corners(std::size_t found) {
    corners += found;
    if (corners > kMaxCalibrationCorners)
      throw base::InputError(from, 0,
                             fmt::format("has boards with more than {} corners in all; expected fewer images or "
                                         "a board of fewer squares",
                                         kMaxCalibrationCorners));
  }
};

}  // namespace

Calibration calibrate(ImageSource& images, const std::string& from, const Chessboard& board,
                      const std::function<void(std::size_t)>& progress) {
  if (images.is_live()) throw base::InputError(from, 0, "is a device; expected a folder of images or a video");
  Extent extent{from};
  extent.check_images(images.size());
  std::vector<std::vector<BoardCorner>> corners;
  for (Image image; images.next(image);) {
    extent.count(image);
    corners.push_back(image.pixels.empty() ? std::vector<BoardCorner>() : opencv().find_board(image, board));
    extent.count_corners(corners.back().size());
    if (progress) progress(corners.size());
  }
  return opencv().calibrate(corners, board, extent.width, extent.height);
}

}  // namespace sf::vision
